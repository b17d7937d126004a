# What only some tests and benchmarks ask. A package that is installed by half can end the configuring that looks for
# it, even when it is looked for quietly: it is tried in a project of its own first.

# dynasurf_find_optional(package language [component...]): find_package(package), where that works; else as if it were
# not there. A macro, for the variables that a package sets.
macro(dynasurf_find_optional package language)
  dynasurf_try_package(${package} ${language} ${ARGN})
  if(DYNASURF_FINDS_${package})
    find_package(${package} QUIET COMPONENTS ${ARGN})
  else()
    set(${package}_FOUND FALSE)
  endif()
endmacro()

# Sets DYNASURF_FINDS_<package>, once for each place where the package is looked for, and again after Debian packages
# came or went.
function(dynasurf_try_package package language)
  file(TIMESTAMP /var/lib/dpkg/status installed)
  set(places "${CMAKE_PREFIX_PATH};${${package}_DIR};${CMAKE_DISABLE_FIND_PACKAGE_${package}};$ENV{PATH};${CMAKE_FIND_PACKAGE_PREFER_CONFIG};${installed}")
  if(DEFINED DYNASURF_FINDS_${package} AND "${DYNASURF_TRIED_${package}}" STREQUAL "${places}")
    return()
  endif()
  set(folder ${PROJECT_BINARY_DIR}/CMakeFiles/try_${package})
  file(REMOVE_RECURSE ${folder})
  file(WRITE ${folder}/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(try LANGUAGES ${language})
find_package(${package} QUIET COMPONENTS ${ARGN})
file(WRITE \${PROJECT_BINARY_DIR}/found \"\${${package}_FOUND}\")
")
  # A list is one argument: its semicolons are escaped.
  set(settings)
  foreach(name IN ITEMS CMAKE_PREFIX_PATH CMAKE_FIND_PACKAGE_PREFER_CONFIG CMAKE_DISABLE_FIND_PACKAGE_${package}
                        ${package}_DIR CMAKE_C_COMPILER CMAKE_CXX_COMPILER)
    if(${name})
      string(REPLACE ";" "\\;" value "${${name}}")
      list(APPEND settings "-D${name}=${value}")
    endif()
  endforeach()
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${folder} -B ${folder}/build -G ${CMAKE_GENERATOR}
                          -DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM} ${settings}
                  OUTPUT_QUIET ERROR_VARIABLE error RESULT_VARIABLE failed)
  set(found FALSE)
  if(failed)
    message(STATUS "${package} is not usable here and is left out: ${folder}/error.txt tells why")
    file(WRITE ${folder}/error.txt "${error}")
  else()
    file(READ ${folder}/build/found found)
  endif()
  set(DYNASURF_FINDS_${package} ${found} CACHE INTERNAL "${package} can be used")
  set(DYNASURF_TRIED_${package} "${places}" CACHE INTERNAL "where it was looked for")
endfunction()

# dynasurf_find_hypre(): HYPRE_FOUND, with HYPRE_INCLUDE_DIR, HYPRE_LIBRARY and MPI's targets. hypre needs MPI.
macro(dynasurf_find_hypre)
  find_path(HYPRE_INCLUDE_DIR HYPRE_struct_ls.h PATH_SUFFIXES hypre)
  find_library(HYPRE_LIBRARY HYPRE)
  set(HYPRE_FOUND FALSE)
  if(HYPRE_INCLUDE_DIR AND HYPRE_LIBRARY)
    dynasurf_find_optional(MPI "C CXX" C CXX)
    if(MPI_FOUND AND TARGET MPI::MPI_C AND TARGET MPI::MPI_CXX)
      set(HYPRE_FOUND TRUE)
    endif()
  endif()
endmacro()

# dynasurf_find_cairo(): DYNASURF_HAS_PICTURES, with CAIRO_INCLUDE_DIR.
macro(dynasurf_find_cairo)
  set(DYNASURF_HAS_PICTURES FALSE)
  if(DYNASURF_WITH_PICTURES)
    find_path(CAIRO_INCLUDE_DIR cairo-svg.h PATH_SUFFIXES cairo)
    find_library(CAIRO_LIBRARY cairo)
    if(CAIRO_INCLUDE_DIR AND CAIRO_LIBRARY)
      set(DYNASURF_HAS_PICTURES TRUE)
    else()
      message(STATUS "cairo was not found (on Debian: libcairo2-dev): no dynasurf show")
    endif()
  endif()
endmacro()
