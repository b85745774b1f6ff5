# repose_flags: what every target of ours is compiled with. NaN must stay detectable, so never
# -ffast-math; errno and floating-point traps are used nowhere, so both may be given up.
add_library(repose_flags INTERFACE)
target_compile_options(repose_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<BOOL:${REPOSE_WERROR}>:-Werror>
  -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms of g++ 12: an overlap or an overflow in "text" + std::string (GCC bugs 105329,
  # 105651), and its own AVX-512 intrinsics, which start from an undefined register (105593). clang
  # keeps watch over all of them.
  target_compile_options(repose_flags INTERFACE
    -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread
    -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
# The processor compiled for, and the least that is asked of it.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  set(repose_x86 ON)
  set(repose_baseline x86-64-v3)
elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
  set(repose_x86 OFF)
  set(repose_baseline armv8-a)
else()
  message(FATAL_ERROR "repose is compiled for x86_64 or aarch64, not for ${CMAKE_SYSTEM_PROCESSOR}: "
                      "its registers (models/scalar.hpp, mpm/grid/lanes.hpp) are AVX-512, AVX2 or NEON")
endif()
foreach(option REPOSE_VECTOR_512 REPOSE_MORE_SETS)
  if(${option} AND NOT repose_x86)
    message(FATAL_ERROR "${option}=${${option}}: there is such a thing on x86_64 only, this is ${CMAKE_SYSTEM_PROCESSOR}")
  endif()
endforeach()
if(REPOSE_MARCH)
  set(repose_march ${REPOSE_MARCH})
elseif(REPOSE_NATIVE AND NOT CMAKE_CROSSCOMPILING)
  set(repose_march native)
else()
  set(repose_march ${repose_baseline})
endif()
target_compile_options(repose_flags INTERFACE -march=${repose_march})
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
# The macros of compiled libraries, for every target alike: a precompiled header is refused where one
# differs.
target_compile_definitions(repose_flags INTERFACE
  $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
target_compile_options(repose_flags INTERFACE
  $<TARGET_PROPERTY:tomlplusplus::tomlplusplus,INTERFACE_COMPILE_OPTIONS>)
# Includes are written from the repository root: #include "models/sym.hpp"
target_include_directories(repose_flags INTERFACE ${PROJECT_SOURCE_DIR})

# repose_add_library(name [KERNELS] SOURCES a.cpp b.cpp ... LIBS targets...)
# A room: a static library whose objects also go into the shared one of Install.cmake. KERNELS: the
# inner loops of a time step or of a path are in it, compiled with all that the compiler can do, a file
# at a time, so that no other file moves a bit of them. In the others two thirds of the compiler's time
# went into optimising what reads, writes and draws: -O1 leaves a third of that away, and their sources
# are joined, eight at a time (REPOSE_UNITY), which halves the rest.
function(repose_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "KERNELS" "" "SOURCES;LIBS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "repose_add_library(${name}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(REPOSE_ROOMS_FROM AND NOT name MATCHES "^repose_(io|input|app)$")
    # what reads is instrumented; what computes and draws is taken as another build has compiled it
    string(REGEX REPLACE "^repose_" "" room ${name})
    string(REPLACE "point" "pointdriver" room ${room})
    string(REPLACE "umat_" "umat/" room ${room})
    add_library(${name} STATIC IMPORTED GLOBAL)
    set_target_properties(${name} PROPERTIES IMPORTED_LOCATION ${REPOSE_ROOMS_FROM}/${room}/lib${name}.a)
    target_link_libraries(${name} INTERFACE repose_flags ${arg_LIBS})
    return()
  endif()
  add_library(${name} STATIC ${arg_SOURCES})
  target_link_libraries(${name} PUBLIC repose_flags ${arg_LIBS})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  # calls inside a shared library are what they are in a program: they may be inlined
  target_compile_options(${name} PRIVATE -fno-semantic-interposition)
  if(arg_KERNELS)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
    repose_precompile(${name} kernels)
  else()
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ${REPOSE_UNITY} UNITY_BUILD_BATCH_SIZE 8)
    repose_precompile(${name} room)
  endif()
endfunction()
