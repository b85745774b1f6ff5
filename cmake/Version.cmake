# repose_version: <build>/generated/repose_version.hpp, refreshed at every build when git's answer
# changes; without git or tags it is the project's version alone. It also has a digest of everything
# that a run's result depends on: what compiles it, and the sources of laws and solver.
add_custom_target(repose_version_header
  COMMAND ${CMAKE_COMMAND}
          -DSOURCE_DIR=${PROJECT_SOURCE_DIR}
          -DVERSION=${PROJECT_VERSION}
          -DOUTPUT=${PROJECT_BINARY_DIR}/generated/repose_version.hpp
          "-DCOMPILED=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS} ${REPOSE_NATIVE} ${REPOSE_VECTOR_512} ${REPOSE_SANITIZE}"
          -P ${PROJECT_SOURCE_DIR}/cmake/WriteVersion.cmake
  BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/repose_version.hpp
  COMMENT "Version" VERBATIM)
add_library(repose_version INTERFACE)
add_dependencies(repose_version repose_version_header)
target_include_directories(repose_version INTERFACE ${PROJECT_BINARY_DIR}/generated)
