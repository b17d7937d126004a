# Bundles web/ into HTML files that the report library carries, and names the tests of the page.

set(web ${PROJECT_SOURCE_DIR}/web)
set(DYNASURF_PAGES ${PROJECT_BINARY_DIR}/web/pages)
set(web_pages ${DYNASURF_PAGES}/report.html ${DYNASURF_PAGES}/cloud.html ${DYNASURF_PAGES}/lod.html ${DYNASURF_PAGES}/cohort.html)

if(DYNASURF_WITH_PAGES)
  find_program(DYNASURF_NODE NAMES node nodejs DOC "Node.js, at least 18: bundles the page of the report")
  find_program(DYNASURF_NPM npm DOC "npm: fetches what the page of the report is made of")
  if(NOT DYNASURF_NODE OR NOT DYNASURF_NPM)
    message(FATAL_ERROR "Node.js and npm bundle the page of the report and were not found. "
                        "On Debian: apt-get install --no-install-recommends nodejs npm")
  endif()
  execute_process(COMMAND ${DYNASURF_NODE} --version OUTPUT_VARIABLE node_version OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX REPLACE "^v" "" node_version "${node_version}")
  if(node_version VERSION_LESS 18)
    message(FATAL_ERROR "${DYNASURF_NODE} is Node.js '${node_version}'; the page of the report needs at least 18")
  endif()

  # npm writes its hidden lock file last, so the file stands for the whole folder. Scripts of packages never run.
  set(web_modules ${web}/node_modules/.package-lock.json)
  add_custom_command(
    OUTPUT ${web_modules}
    COMMAND ${DYNASURF_NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${web_modules}
    DEPENDS ${web}/package.json ${web}/package-lock.json
    WORKING_DIRECTORY ${web}
    COMMENT "Fetching the packages of web/"
    VERBATIM)

  file(GLOB_RECURSE web_sources CONFIGURE_DEPENDS ${web}/src/*)
  add_custom_command(
    OUTPUT ${web_pages}
    COMMAND ${DYNASURF_NODE} ${web}/build.mjs ${DYNASURF_PAGES}
    DEPENDS ${web_sources} ${web}/build.mjs ${web}/bundle.mjs ${web_modules}
    COMMENT "Bundling the pages"
    VERBATIM)
  add_custom_target(web DEPENDS ${web_pages})
else()
  # Reports still hold their data, for programs to read.
  foreach(page IN LISTS web_pages)
    file(WRITE ${page} "<!doctype html><meta charset=\"utf-8\"><title>Dynasurf</title>"
         "<p>This build has no interactive page (DYNASURF_WITH_PAGES=OFF). The data are in the source of this page.</p>"
         "<script type=\"application/json\" id=\"data\">{{DATA}}</script>\n")
  endforeach()
  add_custom_target(web)
endif()

# dynasurf_embed_page(target): the pages as bytes inside a library.
function(dynasurf_embed_page target)
  set(source ${PROJECT_SOURCE_DIR}/src/dynasurf/report/page_template.cpp)
  set_source_files_properties(${source} PROPERTIES
    COMPILE_DEFINITIONS "DYNASURF_REPORT_PAGE=\"${DYNASURF_PAGES}/report.html\";DYNASURF_CLOUD_PAGE=\"${DYNASURF_PAGES}/cloud.html\";DYNASURF_LOD_PAGE=\"${DYNASURF_PAGES}/lod.html\";DYNASURF_COHORT_PAGE=\"${DYNASURF_PAGES}/cohort.html\""
    OBJECT_DEPENDS "${web_pages}")
  add_dependencies(${target} web)
endfunction()

# dynasurf_program_page(): the program, compiled for a browser, as one page: dynasurf.html.
function(dynasurf_program_page)
  set(page ${PROJECT_BINARY_DIR}/dynasurf.html)
  set(engine ${PROJECT_BINARY_DIR}/web/engine.wasm)
  find_program(DYNASURF_WASM_OPT wasm-opt REQUIRED DOC "Binaryen, which clang calls when it links: the size depends on it")
  find_program(DYNASURF_ZOPFLI zopfli REQUIRED DOC "Zopfli: packs it for a page")
  add_custom_command(
    OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -E copy $<TARGET_FILE:dynasurf> ${engine}
    COMMAND ${DYNASURF_ZOPFLI} --i5 ${engine}
    COMMAND ${DYNASURF_NODE} ${web}/build_program.mjs ${engine}.gz ${DYNASURF_PAGES} ${page}
    DEPENDS dynasurf ${web_sources} ${web}/build_program.mjs ${web}/bundle.mjs ${web_pages}
    COMMENT "Making dynasurf.html"
    VERBATIM)
  add_custom_target(dynasurf_page DEPENDS ${page})
endfunction()

# dynasurf_called_by_page(target): a program that stays between its runs, each of which is a call of main, and what a
# thread that the page starts needs.
function(dynasurf_called_by_page target)
  target_link_options(${target} PRIVATE -mexec-model=reactor -Wl,--export=__main_void
                      -Wl,--export=__stack_pointer,--export=__wasm_init_tls,--export=__tls_size)
endfunction()

# dynasurf_browser_tests(): the tests of the rooms that read no files, compiled for a browser, in which
# web/test/library.test.mjs runs them.
function(dynasurf_browser_tests)
  set(googletest /usr/src/googletest)
  if(NOT EXISTS ${googletest})
    message(STATUS "the libraries are not tested in WebAssembly: GoogleTest's sources (package googletest) are missing")
    return()
  endif()
  add_library(googletest STATIC EXCLUDE_FROM_ALL ${googletest}/googletest/src/gtest-all.cc
              ${googletest}/googletest/src/gtest_main.cc ${googletest}/googlemock/src/gmock-all.cc)
  target_compile_features(googletest PUBLIC cxx_std_20)
  target_compile_definitions(googletest PUBLIC GTEST_HAS_PTHREAD=0 GTEST_HAS_STREAM_REDIRECTION=0 GTEST_HAS_DEATH_TEST=0)
  target_include_directories(googletest SYSTEM PUBLIC ${googletest}/googletest/include ${googletest}/googlemock/include
                             PRIVATE ${googletest}/googletest ${googletest}/googlemock)
  add_custom_target(browser_tests)
  foreach(room IN ITEMS field mesh dynamics ventricle cloud)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${room}/*.cpp)
    add_executable(test_${room} EXCLUDE_FROM_ALL ${sources})
    set_target_properties(test_${room} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests SUFFIX .wasm)
    target_include_directories(test_${room} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
    target_link_libraries(test_${room} PRIVATE dynasurf::${room} dynasurf::synthetic googletest)
    dynasurf_called_by_page(test_${room})
    dynasurf_light_test_code(test_${room} <gmock/gmock.h> <gtest/gtest.h>)
    add_dependencies(browser_tests test_${room})
  endforeach()
endfunction()

# dynasurf_page_tests(): the types of the page, the published schema against real output, the page in Chromium.
function(dynasurf_page_tests)
  if(NOT DYNASURF_WITH_PAGES)
    return()
  endif()
  add_executable(make_sample_report ${PROJECT_SOURCE_DIR}/tests/web/make_sample_report.cpp)
  target_include_directories(make_sample_report PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(make_sample_report PRIVATE dynasurf::report dynasurf::mesh)
  dynasurf_light_test_code(make_sample_report)

  set(samples ${CMAKE_BINARY_DIR}/web/samples)
  add_test(NAME web/samples COMMAND make_sample_report ${samples})
  add_test(NAME web/types COMMAND ${DYNASURF_NODE} ${web}/node_modules/typescript/bin/tsc --noEmit -p ${web})
  add_test(NAME web/schema COMMAND ${DYNASURF_NODE} ${web}/test/schema.test.mjs
           ${PROJECT_SOURCE_DIR}/docs/results.schema.json ${samples})
  add_test(NAME web/report COMMAND ${DYNASURF_NODE} ${web}/test/report.test.mjs ${samples})
  set_tests_properties(web/samples PROPERTIES FIXTURES_SETUP sample_reports)
  set_tests_properties(web/schema web/report PROPERTIES FIXTURES_REQUIRED sample_reports)
  set_tests_properties(web/report PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 600)

  add_executable(make_sample_clouds ${PROJECT_SOURCE_DIR}/tests/web/make_sample_clouds.cpp)
  target_link_libraries(make_sample_clouds PRIVATE dynasurf::report dynasurf::mesh)
  dynasurf_light_test_code(make_sample_clouds)
  set(clouds ${CMAKE_BINARY_DIR}/web/sample_clouds)
  add_test(NAME web/sample-clouds COMMAND make_sample_clouds ${clouds})
  add_test(NAME web/cloud-schema COMMAND ${DYNASURF_NODE} ${web}/test/cloud_schema.test.mjs
           ${PROJECT_SOURCE_DIR}/docs/cloud-results.schema.json ${clouds}/results)
  add_test(NAME web/cloud COMMAND ${DYNASURF_NODE} ${web}/test/cloud.test.mjs ${clouds})
  set_tests_properties(web/sample-clouds PROPERTIES FIXTURES_SETUP sample_clouds)
  set_tests_properties(web/cloud-schema web/cloud PROPERTIES FIXTURES_REQUIRED sample_clouds)
  set_tests_properties(web/cloud PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 600)

  add_test(NAME web/words COMMAND ${DYNASURF_NODE} ${web}/test/words.test.mjs ${samples} ${clouds}/results
           $<TARGET_FILE:dynasurf>)
  set_tests_properties(web/words PROPERTIES FIXTURES_REQUIRED "sample_reports;sample_clouds" SKIP_RETURN_CODE 77 TIMEOUT 600)

  # A sample of the same in Firefox, which the variable DYNASURF_BROWSER asks of all tests of pages.
  add_test(NAME web/firefox COMMAND ${DYNASURF_NODE} ${web}/test/report.test.mjs ${samples})
  set_tests_properties(web/firefox PROPERTIES FIXTURES_REQUIRED sample_reports ENVIRONMENT "DYNASURF_BROWSER=firefox;ONLY=surfaces"
                       SKIP_RETURN_CODE 77 TIMEOUT 600)

  # The page that is the program, where ./dev web has made it.
  add_test(NAME web/program COMMAND ${DYNASURF_NODE} ${web}/test/program.test.mjs
           ${PROJECT_SOURCE_DIR}/build/web/dynasurf.html $<TARGET_FILE:dynasurf>)
  add_test(NAME web/library COMMAND ${DYNASURF_NODE} ${web}/test/library.test.mjs ${PROJECT_SOURCE_DIR}/build/web/tests)
  set_tests_properties(web/program web/library PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 1800)
endfunction()
