# repose_flags: what every target of ours is compiled with. NaN must stay detectable, so never
# -ffast-math; errno and floating-point traps are used nowhere, so both may be given up.
add_library(repose_flags INTERFACE)
target_compile_options(repose_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<BOOL:${REPOSE_WERROR}>:-Werror>
  -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms of g++ 12: an overlap in "text" + std::string (GCC bug 105329), and its own AVX-512
  # intrinsics, which start from an undefined register (105593). clang keeps watch over both.
  target_compile_options(repose_flags INTERFACE
    -Wno-restrict -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
if(REPOSE_NATIVE)
  target_compile_options(repose_flags INTERFACE -march=native)
else()
  target_compile_options(repose_flags INTERFACE -march=x86-64-v3)
endif()
if(REPOSE_VECTOR_512)
  target_compile_options(repose_flags INTERFACE -mprefer-vector-width=512)
endif()
if(REPOSE_SANITIZE)
  target_compile_options(repose_flags INTERFACE
    -fsanitize=${REPOSE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(repose_flags INTERFACE -fsanitize=${REPOSE_SANITIZE})
endif()
if(REPOSE_FUZZ)
  # every translation unit reports the branches it takes
  target_compile_options(repose_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
# Includes are written from the repository root: #include "models/sym.hpp"
target_include_directories(repose_flags INTERFACE ${PROJECT_SOURCE_DIR})

# repose_add_library(name SOURCES a.cpp b.cpp ... LIBS targets...)
# A static library, or a header-only (INTERFACE) one as long as no .cpp is listed.
function(repose_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "repose_add_library(${name}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    target_link_libraries(${name} PUBLIC repose_flags ${arg_LIBS})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE repose_flags ${arg_LIBS})
  endif()
endfunction()
