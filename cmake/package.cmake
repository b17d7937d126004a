# Debian packages by CPack: `dynasurf`, the program with its manual, `libdynasurf-dev`, the libraries and headers, and
# `python3-dynasurf`, the Python module, where it is built.
# `./dev package` makes them, checks them with lintian and tries them in a bare Debian.

if(NOT TARGET dynasurf OR NOT TARGET manual)
  message(FATAL_ERROR "DYNASURF_PACKAGE=ON needs the program (DYNASURF_BUILD_APP=ON) and Python 3")
endif()
set(DYNASURF_MAINTAINER "The Dynasurf authors <authors@dynasurf.invalid>" CACHE STRING
    "Name and address that the Debian packages tell")
set(DYNASURF_PACKAGE_REVISION 1 CACHE STRING "Revision of the Debian packages, counted from 1 at each version")

# Documents that Debian wants in every package.
find_program(GZIP gzip REQUIRED)
set(documents ${PROJECT_BINARY_DIR}/documents)
string(TIMESTAMP package_date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where that is set
string(TIMESTAMP package_year "%Y" UTC)
set(packages dynasurf libdynasurf-dev)
if(DYNASURF_HAS_PYTHON)
  list(APPEND packages python3-dynasurf)
endif()
foreach(package IN LISTS packages)
  set(folder ${documents}/${package})
  file(REMOVE_RECURSE ${folder})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/debian/copyright.in ${folder}/copyright @ONLY)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/debian/changelog.in ${folder}/changelog.Debian @ONLY)
  file(COPY_FILE ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${folder}/changelog)
  execute_process(COMMAND ${GZIP} -9nf ${folder}/changelog ${folder}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
endforeach()
install(DIRECTORY ${documents}/dynasurf DESTINATION ${CMAKE_INSTALL_DATADIR}/doc COMPONENT program)
install(DIRECTORY ${documents}/libdynasurf-dev DESTINATION ${CMAKE_INSTALL_DATADIR}/doc COMPONENT development)
if(DYNASURF_HAS_PYTHON)
  install(DIRECTORY ${documents}/python3-dynasurf DESTINATION ${CMAKE_INSTALL_DATADIR}/doc COMPONENT python)
endif()

# The program in one page, where ./dev web has made it; `dynasurf view` opens it.
install(FILES ${PROJECT_SOURCE_DIR}/build/web/dynasurf.html DESTINATION ${CMAKE_INSTALL_DATADIR}/dynasurf
        COMPONENT program OPTIONAL)

# CMake strips programs; Debian wants its static libraries without debug sections and comments too.
install(CODE "
  if(CMAKE_INSTALL_DO_STRIP)
    file(GLOB libraries \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/libdynasurf_*.a\")
    execute_process(COMMAND ${CMAKE_STRIP} --strip-debug --remove-section=.comment --remove-section=.note
                            --enable-deterministic-archives \${libraries} COMMAND_ERROR_IS_FATAL ANY)
  endif()" COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dynasurf)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package begins with its own
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${DYNASURF_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${DYNASURF_PACKAGE_REVISION})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME dynasurf)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS chromium)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "surfaces of the left ventricle and of scanned bodies
Dynasurf reads a gated SPECT, PET, MR or CT study of the heart (DICOM, NIfTI
or NRRD) and finds the inner and the outer border of the left ventricle in
every gate. It reports volumes, ejection fraction and regional measures with
their uncertainty, and writes meshes and a report for the browser.
.
From a scanned point cloud it makes closed triangle meshes at several levels of
detail, each with a certificate of its quality.
.
Research use only. Not for diagnosis.")

set(development_needs libeigen3-dev libtbb-dev nlohmann-json3-dev zlib1g-dev libpng-dev libpugixml-dev libmeshoptimizer-dev libssl-dev libsqlite3-dev libcairo2-dev)
if(DYNASURF_WITH_DICOM)
  list(APPEND development_needs libdcmtk-dev)
endif()
list(JOIN development_needs ", " development_needs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libdynasurf-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ${development_needs})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "surfaces from heart studies and point clouds: libraries
The stages of the program dynasurf as C++20 libraries: images and edges,
gradient vector flow fields, deformable surfaces, triangle meshes,
reconstruction of the left ventricle and of point clouds, files and reports.
.
This package holds static libraries, headers, a package for CMake's
find_package and a file for pkg-config.
.
Research use only. Not for diagnosis.")

if(DYNASURF_HAS_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-dynasurf)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-nibabel, python3-pandas, python3-tqdm")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "surfaces from heart studies and point clouds: Python module
The stages of the program dynasurf in Python, with NumPy arrays: images and
edges, gradient vector flow fields, deformable surfaces, triangle meshes, the
left ventricle, point clouds, files.
.
Research use only. Not for diagnosis.")
endif()

include(CPack)
