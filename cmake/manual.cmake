# The manual pages and the shell completions, from what the program prints as --help. The target `manual` makes them;
# what was made is installed.

if(NOT TARGET dynasurf)
  return()
endif()
find_package(Python3 QUIET COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND)
  message(STATUS "Python 3 was not found: no manual pages and shell completions")
  return()
endif()

set(manual ${PROJECT_BINARY_DIR}/manual)
set(manual_default "")
if(DYNASURF_PACKAGE)
  set(manual_default ALL)
endif()
add_custom_command(
  OUTPUT ${manual}/man1/dynasurf.1.gz
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${manual}
  COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/tools/manual.py $<TARGET_FILE:dynasurf> ${manual}
  DEPENDS dynasurf ${PROJECT_SOURCE_DIR}/tools/manual.py
  COMMENT "Writing the manual pages"
  VERBATIM)
add_custom_target(manual ${manual_default} DEPENDS ${manual}/man1/dynasurf.1.gz)

install(DIRECTORY ${manual}/man1/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program OPTIONAL)
install(DIRECTORY ${manual}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program
        OPTIONAL)
install(DIRECTORY ${manual}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program OPTIONAL)
