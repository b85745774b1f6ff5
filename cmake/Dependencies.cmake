# Everything comes from the distribution; configure downloads nothing.
# Imported targets are SYSTEM by default, so our warnings do not reach third-party headers.
set(repose_missing "")

# repose_find(PACKAGE debian-packages [find_package arguments...]): collects what is missing so that
# one message names it all.
macro(repose_find package debian)
  find_package(${package} QUIET ${ARGN})
  if(${package}_FOUND)
    string(STRIP "repose: ${package} ${${package}_VERSION}" found)
    message(STATUS ${found})
  else()
    list(APPEND repose_missing "${package}: apt-get install ${debian}")
  endif()
endmacro()

repose_find(Eigen3 libeigen3-dev 3.4 CONFIG)
repose_find(xsimd libxsimd-dev 8.1 CONFIG)
repose_find(fmt libfmt-dev CONFIG)
repose_find(nlohmann_json nlohmann-json3-dev CONFIG)
repose_find(CLI11 libcli11-dev CONFIG)
repose_find(tomlplusplus libtomlplusplus-dev CONFIG)
repose_find(TBB libtbb-dev CONFIG)
repose_find(HDF5 libhdf5-dev COMPONENTS C)
repose_find(SUNDIALS libsundials-dev CONFIG)
repose_find(NLopt "libnlopt-dev libnlopt-cxx-dev")
if(REPOSE_TESTS)
  repose_find(GTest libgtest-dev CONFIG)
endif()
if(REPOSE_BENCH)
  repose_find(benchmark libbenchmark-dev CONFIG)
endif()

if(REPOSE_SANITIZE MATCHES thread AND TBB_DIR AND NOT TBB_DIR MATCHES "/tbb-tsan/")
  message(WARNING "TBB from ${TBB_DIR} is not built with the thread sanitizer, which will report races "
                  "that are none; scripts/tsan builds one that is.")
endif()

# ceres/jet.h is header only and serves as the dual number; the ceres library itself is not linked.
find_path(CERES_JET_INCLUDE_DIR ceres/jet.h)
mark_as_advanced(CERES_JET_INCLUDE_DIR)
if(CERES_JET_INCLUDE_DIR)
  message(STATUS "repose: ceres/jet.h in ${CERES_JET_INCLUDE_DIR}")
else()
  list(APPEND repose_missing "ceres/jet.h: apt-get install libceres-dev")
endif()

# Optional: maps of other kinds than the ESRI ASCII grid (io/raster_file.hpp). Loaded by its name where a
# map asks for it, as the loader knows it (libgdal.so.32), and never linked.
if(REPOSE_GDAL)
  find_package(GDAL 3.0 QUIET)
  if(GDAL_FOUND AND GDAL_LIBRARY AND CMAKE_OBJDUMP)
    execute_process(COMMAND ${CMAKE_OBJDUMP} -p ${GDAL_LIBRARY} OUTPUT_VARIABLE repose_gdal_headers ERROR_QUIET)
    if(repose_gdal_headers MATCHES "SONAME +([^ \n]+)")
      set(repose_gdal_library ${CMAKE_MATCH_1})
    endif()
  endif()
  if(repose_gdal_library)
    message(STATUS "repose: GDAL ${GDAL_VERSION}, loaded as ${repose_gdal_library} where a map needs it")
  else()
    set(GDAL_FOUND FALSE)
    message(STATUS "repose: no GDAL (apt-get install libgdal-dev): maps are ESRI ASCII grids")
  endif()
endif()

if(repose_missing)
  list(JOIN repose_missing "\n  " repose_missing)
  message(FATAL_ERROR "repose needs packages that are not installed:\n  ${repose_missing}\n"
                      "scripts/packages installs all of them on Debian 12.")
endif()

# Debian's imported target xsimd links xtl, which libxsimd-dev does not depend on;
# the headers are all that is needed.
add_library(repose_simd INTERFACE)
target_include_directories(repose_simd SYSTEM INTERFACE ${xsimd_INCLUDE_DIRS})

add_library(repose_jet INTERFACE)
target_include_directories(repose_jet SYSTEM INTERFACE ${CERES_JET_INCLUDE_DIR})
target_link_libraries(repose_jet INTERFACE Eigen3::Eigen)
