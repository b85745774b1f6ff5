# What other programs link: shared libraries repose::models, repose::io, repose::pointdriver,
# repose::mpm and repose::calibration, their headers under repose/, and the files of
# find_package(repose). Included last, when the rooms' targets exist.
#
# Nothing of how a program is compiled may change what the library computes, so
#   - what goes between them has the same memory for every instruction set (no SIMD register, no
#     dual number, no Eigen matrix in a header listed here, but for the kit of a law);
#   - the libraries bind to their own inline functions (-Bsymbolic-functions): the ones that a
#     program compiles from the same headers, for another instruction set, never take their place.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(repose_public_headers
  calibration/fit.hpp
  calibration/free_parameter.hpp
  io/atomic_file.hpp
  io/csv_columns.hpp
  io/frame_reader.hpp
  io/frame_writer.hpp
  io/geojson.hpp
  io/json.hpp
  io/raster.hpp
  io/vtkhdf.hpp
  models/batch_law.hpp
  models/ill_posedness.hpp
  models/instruction_set.hpp
  models/law.hpp
  models/material.hpp
  models/padding.hpp
  models/parameter.hpp
  models/registry.hpp
  models/scalar_traits.hpp
  models/sym.hpp
  models/tangent.hpp
  mpm/grid/numerical_failure.hpp
  mpm/output/history.hpp
  mpm/output/rest_pressure.hpp
  mpm/scene/box_tree.hpp
  mpm/scene/height_map.hpp
  mpm/scene/nearest.hpp
  mpm/scene/poly_line.hpp
  mpm/scene/prescribed.hpp
  mpm/scene/scene.hpp
  mpm/scene/solid.hpp
  mpm/scene/terrain.hpp
  mpm/scene/triangle_mesh.hpp
  mpm/step/simulation.hpp
  mpm/study/estimate.hpp
  mpm/study/ill_posed_points.hpp
  pointdriver/integrate/gradient.hpp
  pointdriver/integrate/material_driver.hpp
  pointdriver/integrate/outside_driver.hpp
  pointdriver/integrate/simulate.hpp
  pointdriver/path/control.hpp
  pointdriver/path/curve.hpp
  pointdriver/path/history.hpp
  pointdriver/path/laboratory.hpp
  pointdriver/path/path.hpp
  pointdriver/path/settings.hpp
  pointdriver/path/status.hpp)
# The kit of a law (repose::law_kit): what a program includes that brings a law of its own. These
# are compiled for the program's instruction set, in its own code.
set(repose_law_headers
  models/dual.hpp
  models/law_material.hpp
  models/objective.hpp
  models/register_law.hpp
  models/scalar.hpp
  models/shear_response.hpp
  pointdriver/integrate/adaptive.hpp
  pointdriver/integrate/bracketed_zero.hpp
  pointdriver/integrate/drive.hpp
  pointdriver/integrate/flow.hpp
  pointdriver/integrate/implicit.hpp
  pointdriver/integrate/leg_run.hpp
  pointdriver/integrate/plain_rows.hpp
  pointdriver/integrate/register_law.hpp
  pointdriver/integrate/start.hpp
  pointdriver/integrate/sundials_drive.hpp
  pointdriver/integrate/sundials_solver.hpp)

# repose_export(room name NEEDS rooms LIBS targets): the shared library of a room, made of the
# objects of its static one.
function(repose_export room name)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "NEEDS;LIBS")
  add_library(${room}_shared SHARED $<TARGET_OBJECTS:${room}>)
  set_target_properties(${room}_shared PROPERTIES
    LINKER_LANGUAGE CXX
    OUTPUT_NAME repose_${name}
    EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    INSTALL_RPATH "$ORIGIN")
  target_link_options(${room}_shared PRIVATE
    LINKER:-Bsymbolic-functions LINKER:--no-undefined LINKER:--as-needed)
  target_compile_features(${room}_shared INTERFACE cxx_std_20)
  target_include_directories(${room}_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  list(TRANSFORM arg_NEEDS APPEND _shared)
  target_link_libraries(${room}_shared PUBLIC ${arg_NEEDS} PRIVATE ${arg_LIBS})
  install(TARGETS ${room}_shared EXPORT repose
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

set(repose_sundials SUNDIALS::cvodes SUNDIALS::ida SUNDIALS::arkode
    SUNDIALS::nvecserial SUNDIALS::sunmatrixdense SUNDIALS::sunlinsoldense)
repose_export(repose_models models)
repose_export(repose_io io LIBS TBB::tbb fmt::fmt hdf5::hdf5)
repose_export(repose_point pointdriver NEEDS repose_models LIBS ${repose_sundials})
repose_export(repose_mpm mpm NEEDS repose_models repose_io LIBS TBB::tbb fmt::fmt hdf5::hdf5)
repose_export(repose_calibration calibration NEEDS repose_models repose_point
              LIBS NLopt::nlopt TBB::tbb)

install(TARGETS repose RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# In the tree an include is written from its root, "models/law.hpp"; installed, "repose/models/law.hpp".
install(CODE "
  set(repose_source \"${PROJECT_SOURCE_DIR}\")
  set(repose_headers ${repose_public_headers} ${repose_law_headers})
  set(repose_version_header \"${PROJECT_BINARY_DIR}/generated/repose_version.hpp\")
  set(repose_include \"${CMAKE_INSTALL_INCLUDEDIR}/repose\")")
install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake)

set(repose_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/repose)
install(EXPORT repose NAMESPACE repose:: FILE reposeTargets.cmake DESTINATION ${repose_cmake_dir})
configure_package_config_file(cmake/reposeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/generated/reposeConfig.cmake INSTALL_DESTINATION ${repose_cmake_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/reposeConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/reposeConfig.cmake
              ${PROJECT_BINARY_DIR}/generated/reposeConfigVersion.cmake
        DESTINATION ${repose_cmake_dir})
install(FILES NOTICE CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY data/experiments data/scenes data/sensitivity DESTINATION ${CMAKE_INSTALL_DATADIR}/repose)
