# repose_python_found: whether there is what the Python package is built with, pybind11 and a Python 3
# that has numpy. Nothing is missing without them: the package is then left out, with a line that says
# so. Python3_EXECUTABLE says which Python; otherwise it is the distribution's, to whose numpy and
# matplotlib the package belongs.
set(repose_python_found FALSE)
if(NOT Python3_EXECUTABLE)
  find_program(Python3_EXECUTABLE python3 PATHS /usr/bin /bin NO_DEFAULT_PATH)
endif()
find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
if(Python3_FOUND)
  find_package(pybind11 2.10 QUIET CONFIG)
  execute_process(COMMAND ${Python3_EXECUTABLE} -c "import numpy; print(numpy.__version__)"
                  OUTPUT_VARIABLE repose_numpy OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
                  RESULT_VARIABLE repose_numpy_failed)
  if(pybind11_FOUND AND NOT repose_numpy_failed)
    set(repose_python_found TRUE)
  endif()
endif()
if(repose_python_found)
  message(STATUS "repose: Python ${Python3_VERSION}, pybind11 ${pybind11_VERSION}, numpy ${repose_numpy}")
else()
  message(STATUS "repose: no Python package (scripts/packages python installs what it takes)")
endif()
