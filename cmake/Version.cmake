# repose_version: <build>/generated/repose_version.hpp, refreshed at every build when git's answer
# changes; without git or tags it is the project's version alone. It also has a digest of everything
# that a run's result depends on: what compiles it, and the sources of laws and solver.
#
# The compiler's own macros say for which instruction set it compiles, -march=native included, and
# which optimisations it takes; libraries whose headers compute say their versions.
separate_arguments(repose_flags_of_type UNIX_COMMAND
                   "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_RELEASE}")
list(APPEND repose_flags_of_type -march=${repose_march})
execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${repose_flags_of_type} -dM -E -x c++ /dev/null
                OUTPUT_VARIABLE repose_compiler_macros ERROR_QUIET)
string(SHA256 repose_compiler_macros "${repose_compiler_macros}")
set(repose_libraries "${Eigen3_VERSION} ${xsimd_VERSION} ${SUNDIALS_VERSION} ${NLOPT_VERSION} ${TBB_VERSION}")
add_custom_target(repose_version_header
  COMMAND ${CMAKE_COMMAND}
          -DSOURCE_DIR=${PROJECT_SOURCE_DIR}
          -DVERSION=${PROJECT_VERSION}
          -DOUTPUT=${PROJECT_BINARY_DIR}/generated/repose_version.hpp
          "-DCOMPILED=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_RELEASE} ${repose_march} ${REPOSE_VECTOR_512} ${REPOSE_SANITIZE} ${REPOSE_UNITY} ${repose_compiler_macros} ${repose_libraries}"
          -P ${PROJECT_SOURCE_DIR}/cmake/WriteVersion.cmake
  BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/repose_version.hpp
  COMMENT "Version" VERBATIM)
add_library(repose_version INTERFACE)
add_dependencies(repose_version repose_version_header)
target_include_directories(repose_version INTERFACE ${PROJECT_BINARY_DIR}/generated)
