# repose_add_test(name LABEL unit|contract|verification|regression [NIGHTLY]
#                 SOURCES a.cpp ... [LIBS targets...])
# One GoogleTest executable; every TEST in it is a ctest test with that label. NIGHTLY adds the label
# "nightly", which scripts/test leaves out unless it is asked for. The target FOLDER_LABEL_tests, as in
# models_unit_tests, builds those of a folder and label that are not.
include(GoogleTest)

function(repose_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "NIGHTLY" "LABEL" "SOURCES;LIBS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "repose_add_test(${name}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_LABEL MATCHES "^(unit|contract|verification|regression)$")
    message(FATAL_ERROR "repose_add_test(${name}): LABEL is '${arg_LABEL}', "
                        "one of unit, contract, verification, regression is needed")
  endif()
  if(NOT arg_SOURCES)
    message(FATAL_ERROR "repose_add_test(${name}): no SOURCES")
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE repose_flags ${arg_LIBS} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE REPOSE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # what is tested is compiled as it is for users; what tests it need not be
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  repose_precompile(${name} test)
  if(NOT arg_NIGHTLY)
    get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    if(NOT TARGET ${folder}_${arg_LABEL}_tests)
      add_custom_target(${folder}_${arg_LABEL}_tests)
    endif()
    add_dependencies(${folder}_${arg_LABEL}_tests ${name})
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${arg_LABEL})
  if(arg_NIGHTLY)
    # gtest_discover_tests cannot pass a list of labels on, so a second file that ctest reads does.
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}_nightly.cmake)
    file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[
if(@name@_TESTS)
  set_tests_properties(${@name@_TESTS} PROPERTIES LABELS "@arg_LABEL@;nightly")
endif()
]])
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
  endif()
endfunction()
