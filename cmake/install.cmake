# What `cmake --install` puts where: the libraries, their headers, the package for find_package, dynasurf.pc, the
# program and its manual.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dynasurf)
install(TARGETS ${dynasurf_modules} EXPORT dynasurfTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT dynasurfTargets NAMESPACE dynasurf:: DESTINATION ${package_dir} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/dynasurf DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILES_MATCHING PATTERN "*.hpp")

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/dynasurfConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/dynasurfConfig.cmake INSTALL_DESTINATION ${package_dir})
# Until 1.0 a new minor version may rename things.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/dynasurfConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/dynasurfConfig.cmake ${PROJECT_BINARY_DIR}/dynasurfConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT development)

# Static libraries: whoever links them links what they need, the rooms from the roof down.
set(pc_libraries "")
foreach(module IN LISTS dynasurf_modules)
  string(PREPEND pc_libraries "-l${module} ")
endforeach()
set(pc_private "-ltbb -lcrypto -lpng -lpugixml -lmeshoptimizer -lz -lpthread")
if(DYNASURF_WITH_COHORTS)
  string(PREPEND pc_private "-lsqlite3 ")
endif()
if(DYNASURF_HAS_PICTURES)
  string(PREPEND pc_private "-lcairo ")
endif()
if(DYNASURF_WITH_DICOM)
  # By name: Debian's dcmtk.pc asks for packages that its own package does not bring.
  string(PREPEND pc_private "-ldcmdata -loflog -lofstd ")
endif()
# Relative to the file itself, so that `cmake --install --prefix` may choose another place.
file(RELATIVE_PATH pc_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/dynasurf.pc.in ${PROJECT_BINARY_DIR}/dynasurf.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/dynasurf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

if(TARGET dynasurf)
  install(TARGETS dynasurf RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
