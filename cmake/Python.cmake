# repose_python_found: whether there is what the Python package is built with, pybind11 and the headers of a
# Python 3. Nothing is missing without them: the package is then left out, with a line that says so.
# Python3_EXECUTABLE says which Python; otherwise it is the distribution's, to whose numpy and matplotlib
# the package belongs. repose_python_tested: whether those two are there, which only its tests import.
set(repose_python_found FALSE)
set(repose_python_tested FALSE)
if(NOT Python3_EXECUTABLE)
  find_program(Python3_EXECUTABLE python3 PATHS /usr/bin /bin NO_DEFAULT_PATH)
endif()
find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
if(Python3_FOUND)
  find_package(pybind11 2.10 QUIET CONFIG)
  if(pybind11_FOUND)
    set(repose_python_found TRUE)
    message(STATUS "repose: Python ${Python3_VERSION}, pybind11 ${pybind11_VERSION}")
    execute_process(COMMAND ${Python3_EXECUTABLE} -c "import numpy, matplotlib" OUTPUT_QUIET ERROR_QUIET
                    RESULT_VARIABLE repose_python_lacks)
    if(repose_python_lacks EQUAL 0)
      set(repose_python_tested TRUE)
    elseif(REPOSE_TESTS)
      message(STATUS "repose: no tests of the Python package: that Python lacks numpy or matplotlib")
    endif()
  endif()
endif()
if(NOT repose_python_found)
  message(STATUS "repose: no Python package (scripts/packages python installs what it takes)")
endif()
