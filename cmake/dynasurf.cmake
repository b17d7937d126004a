# Warnings, sanitizers and floating point rules shared by every target, and one function per kind of target.

add_library(dynasurf_flags INTERFACE)
target_compile_options(dynasurf_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
# Contraction to fused multiply-add would make results depend on the machine; the same bytes everywhere come first.
target_compile_options(dynasurf_flags INTERFACE -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of overlapping copies inside its own operator+(const char*, std::string&&) (GCC bug 105651).
  target_compile_options(dynasurf_flags INTERFACE -Wno-restrict)
endif()
if(DYNASURF_WERROR)
  target_compile_options(dynasurf_flags INTERFACE -Werror)
endif()
# Against mistakes in reading hostile files: stacks, copies, jumps and indices are checked. Sanitizers check more.
if(NOT DYNASURF_SANITIZE)
  target_compile_options(dynasurf_flags INTERFACE -fstack-protector-strong -fstack-clash-protection)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|i.86")
    target_compile_options(dynasurf_flags INTERFACE -fcf-protection)
  endif()
  # glibc checks copies only in optimised code; a distribution may have set another level.
  target_compile_options(dynasurf_flags INTERFACE "$<$<CONFIG:Release>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>")
  target_link_options(dynasurf_flags INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
if(DYNASURF_SANITIZE)
  target_compile_options(dynasurf_flags INTERFACE -fsanitize=${DYNASURF_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(dynasurf_flags INTERFACE -fsanitize=${DYNASURF_SANITIZE})
endif()

# dynasurf_module(name [READS_FILES] USES PUBLIC ... PRIVATE ...): a static library from src/dynasurf/<name>.
function(dynasurf_module name)
  cmake_parse_arguments(ARG "READS_FILES" "" "USES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/dynasurf/${name}/*.cpp)
  set(target dynasurf_${name})
  if(sources)
    add_library(${target} STATIC ${sources})
    target_include_directories(${target} PUBLIC ${CMAKE_SOURCE_DIR}/src)
    target_link_libraries(${target} ${ARG_USES} PRIVATE dynasurf_flags)
    if(ARG_READS_FILES AND NOT DYNASURF_SANITIZE)
      # Indices of containers are checked where files decide them. The inner loops of the numeric rooms, which get what
      # was checked here, are spared.
      target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
    endif()
  else()
    # A module of headers alone passes everything on to its users.
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${CMAKE_SOURCE_DIR}/src)
    list(TRANSFORM ARG_USES REPLACE "^(PUBLIC|PRIVATE)$" "INTERFACE")
    target_link_libraries(${target} ${ARG_USES})
  endif()
  add_library(dynasurf::${name} ALIAS ${target})
endfunction()

# dynasurf_test(name LIBRARIES ...): a GoogleTest program from tests/<name>/*.cpp; every case is one ctest test.
function(dynasurf_test name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_include_directories(test_${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} dynasurf_flags GTest::gmock GTest::gtest_main)
  # Tests spend their time in the libraries; optimising the tests themselves would only make them slower to build.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  gtest_discover_tests(test_${name} TEST_PREFIX "${name}/" PROPERTIES TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endfunction()
