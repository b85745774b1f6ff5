# REPOSE_MORE_SETS: the same sources once more for every instruction set named there, in a build folder of
# their own. `repose` hands over to lib/repose/LEVEL/repose (app/other_sets.hpp); of the libraries the
# loader itself takes those in lib/glibc-hwcaps/LEVEL, where glibc 2.33 and later look first.
include(ExternalProject)
foreach(level IN LISTS REPOSE_MORE_SETS)
  set(build ${PROJECT_BINARY_DIR}/sets/${level})
  ExternalProject_Add(repose_${level}
    SOURCE_DIR ${PROJECT_SOURCE_DIR}
    BINARY_DIR ${build}
    CMAKE_ARGS -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
               -DREPOSE_MARCH=${level} -DREPOSE_TESTS=OFF -DREPOSE_CCACHE=${REPOSE_CCACHE}
               -DREPOSE_UNITY=${REPOSE_UNITY}
    INSTALL_COMMAND ${CMAKE_COMMAND} -E copy ${build}/bin/repose
                    ${PROJECT_BINARY_DIR}/lib/repose/${level}/repose
    BUILD_ALWAYS TRUE
    USES_TERMINAL_BUILD TRUE)
  install(PROGRAMS ${build}/bin/repose DESTINATION lib/repose/${level})
  install(DIRECTORY ${build}/lib/ DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${level}
    FILES_MATCHING PATTERN "librepose_*.so*")
endforeach()
