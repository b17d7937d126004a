# The Python module, where what it needs is there; what is missing is told and ends the
# configuring only with DYNASURF_WITH_PYTHON=REQUIRED.

set(DYNASURF_HAS_PYTHON FALSE)
# With sanitizers only where it is asked for: the interpreter must load them first, as tools/python_sanitized.sh does.
if(DYNASURF_WITH_PYTHON STREQUAL "REQUIRED" OR (DYNASURF_WITH_PYTHON AND NOT DYNASURF_SANITIZE))
  find_package(Python3 QUIET COMPONENTS Interpreter OPTIONAL_COMPONENTS Development.Module)
  # Its headers are all that is needed; its own package looks for another Python than the one above.
  find_path(DYNASURF_PYBIND11 pybind11/pybind11.h DOC "Folder of the headers of pybind11")
  if(TARGET Python3::Module AND DYNASURF_PYBIND11)
    set(DYNASURF_HAS_PYTHON TRUE)
    add_subdirectory(python)
  else()
    set(missing "pybind11 or the headers of Python were not found (on Debian: pybind11-dev, python3-dev)")
    if(DYNASURF_WITH_PYTHON STREQUAL "REQUIRED")
      message(FATAL_ERROR "${missing}")
    endif()
    message(STATUS "The Python module is left out: ${missing}")
  endif()
endif()
