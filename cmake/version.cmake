# Writes version.cpp, and only when something changed. Called with SOURCE, OUTPUT and VERSION at every build.

set(commit "unknown")
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD
  OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(NOT failed)
  set(commit ${head})
  execute_process(COMMAND git -C ${SOURCE} diff --quiet HEAD -- src app web CMakeLists.txt cmake
    ERROR_QUIET RESULT_VARIABLE changed)
  if(changed)
    string(APPEND commit "+changes")
  endif()
endif()

set(text "#include \"version.hpp\"\n
namespace dynasurf::app {\n
const char* version() { return \"${VERSION}\"; }
const char* commit() { return \"${commit}\"; }\n
}  // namespace dynasurf::app\n")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} present)
endif()
if(NOT text STREQUAL "${present}")
  file(WRITE ${OUTPUT} "${text}")
endif()
