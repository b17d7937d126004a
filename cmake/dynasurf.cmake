# Warnings, sanitizers and floating point rules shared by every target, and one function per kind of target.

add_library(dynasurf_flags INTERFACE)
target_compile_options(dynasurf_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
# Contraction to fused multiply-add would make results depend on the machine; the same bytes everywhere come first.
target_compile_options(dynasurf_flags INTERFACE -ffp-contract=off)
# Nothing looks at errno or at exceptions of floating point. Without them no value changes, and loops of roots, roundings
# and choices become vectors.
target_compile_options(dynasurf_flags INTERFACE -fno-math-errno -fno-trapping-math)
# Eigen would sum in an order that depends on the width of the machine's vectors, and fuse where it has no macro against
# it. What the compiler makes of plain loops keeps their order. Types keep the alignment that users of the library see.
target_compile_definitions(dynasurf_flags INTERFACE EIGEN_DONT_VECTORIZE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MAX_STATIC_ALIGN_BYTES=16)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of overlapping copies inside its own operator+(const char*, std::string&&) (GCC bug 105651).
  target_compile_options(dynasurf_flags INTERFACE -Wno-restrict)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Vectors of 64 bytes never pass between compilers of different versions here.
  target_compile_options(dynasurf_flags INTERFACE -Wno-psabi)
endif()
if(DYNASURF_WERROR)
  target_compile_options(dynasurf_flags INTERFACE -Werror)
endif()
# The same bug, where the library's headers are precompiled, tells of copies of half the address space. Sources that put
# texts together are spared both warnings; the others keep them.
add_library(dynasurf_text_flags INTERFACE)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(dynasurf_text_flags INTERFACE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
endif()
# Against mistakes in reading hostile files: stacks, copies, jumps and indices are checked. Sanitizers check more.
if(NOT DYNASURF_SANITIZE AND NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "wasm32")  # which has a stack of its own for calls
  target_compile_options(dynasurf_flags INTERFACE -fstack-protector-strong -fstack-clash-protection)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|i.86")
    target_compile_options(dynasurf_flags INTERFACE -fcf-protection)
  endif()
  # glibc checks copies only in optimised code; a distribution may have set another level.
  target_compile_options(dynasurf_flags INTERFACE "$<$<CONFIG:Release>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>")
  target_link_options(dynasurf_flags INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
if(DYNASURF_SANITIZE)
  target_compile_options(dynasurf_flags INTERFACE -fsanitize=${DYNASURF_SANITIZE} -fno-omit-frame-pointer)
  # An unsigned number that wraps around is defined, so that the program can go on to tell the next one.
  if(NOT DYNASURF_SANITIZE MATCHES "integer")
    target_compile_options(dynasurf_flags INTERFACE -fno-sanitize-recover=all)
  endif()
  target_link_options(dynasurf_flags INTERFACE -fsanitize=${DYNASURF_SANITIZE})
endif()

# What most sources include takes a compiler seconds: it is read once for each kind of target. Nothing relies on it;
# with DYNASURF_PRECOMPILE=OFF every source stands by its own includes.
option(DYNASURF_PRECOMPILE "Precompile the headers that most sources include" ON)
set(dynasurf_common_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
    <mutex> <numbers> <numeric> <optional> <set> <span> <sstream> <stop_token> <string> <string_view> <utility>
    <variant> <vector> <Eigen/Dense>)

# dynasurf_precompile(target [header...]): the common headers and these.
function(dynasurf_precompile target)
  if(DYNASURF_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${dynasurf_common_headers} ${ARGN})
  endif()
endfunction()

# What reads and writes has no loop that the compiler's last efforts would speed up.
add_library(dynasurf_light_flags INTERFACE)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "wasm32")
  target_compile_options(dynasurf_light_flags INTERFACE $<$<CONFIG:Release>:-Oz>)  # it travels inside a page
else()
  target_compile_options(dynasurf_light_flags INTERFACE $<$<CONFIG:Release>:-O2>)
endif()

# Modules whose flags are the same share what the first of them precompiled.
function(dynasurf_precompile_module target reads_files)
  if(NOT DYNASURF_PRECOMPILE)
    return()
  endif()
  get_property(first GLOBAL PROPERTY dynasurf_precompiled_${reads_files})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
    return()
  endif()
  if(reads_files)
    dynasurf_precompile(${target} <nlohmann/json.hpp>)
  else()
    dynasurf_precompile(${target})
  endif()
  set_property(GLOBAL PROPERTY dynasurf_precompiled_${reads_files} ${target})
endfunction()

# Most of what a compiler does for a small source is the templates of the libraries it uses, again and again: a few of
# them are compiled at once. Names without linkage then share a scope with those of their neighbours.
# The preset `dev` compiles every source alone, which shows what one forgot to include and whose names hide others.
option(DYNASURF_JOIN_SOURCES "Compile several small sources at once" ON)

add_library(dynasurf_joined_flags INTERFACE)
target_compile_options(dynasurf_joined_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-shadow$<SEMICOLON>-Wshadow=local>
                                                        $<$<CXX_COMPILER_ID:Clang>:-Wno-shadow>)

# dynasurf_join_sources(target [source...]): all but these, which take long by themselves or share names with others.
function(dynasurf_join_sources target)
  if(NOT DYNASURF_JOIN_SOURCES)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:dynasurf_joined_flags>)
endfunction()

# dynasurf_choose(list first second wanted): leaves out the second of two sources that do the same where the first is
# wanted, else the first.
function(dynasurf_choose list first second wanted)
  if(wanted)
    list(FILTER ${list} EXCLUDE REGEX "/${second}\\.cpp$")
  else()
    list(FILTER ${list} EXCLUDE REGEX "/${first}\\.cpp$")
  endif()
  set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# dynasurf_module(name [READS_FILES] [ALONE source...] USES PUBLIC ... PRIVATE ...): a static library from
# src/dynasurf/<name>. Its sources are joined but for these.
function(dynasurf_module name)
  cmake_parse_arguments(ARG "READS_FILES" "" "ALONE;USES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/dynasurf/${name}/*.cpp)
  if(DYNASURF_WITH_DICOM)
    list(FILTER sources EXCLUDE REGEX "/without_dicom\\.cpp$")
  else()
    list(FILTER sources EXCLUDE REGEX "/io/dicom_[a-z]*\\.cpp$")
  endif()
  dynasurf_choose(sources parallel_tbb "parallel_(serial|workers)" ${DYNASURF_WITH_THREADS})
  dynasurf_choose(sources parallel_workers parallel_serial "${DYNASURF_WITH_WORKERS}")
  dynasurf_choose(sources sha256_openssl sha256_portable ${DYNASURF_WITH_OPENSSL})
  set(target dynasurf_${name})
  add_library(${target} STATIC ${sources})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  # Flags are for the build alone: users choose their own.
  target_link_libraries(${target} ${ARG_USES} PRIVATE $<BUILD_INTERFACE:dynasurf_flags>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ${DYNASURF_WITH_THREADS})
  if(ARG_READS_FILES AND NOT DYNASURF_SANITIZE)
    # Indices of containers are checked where files decide them. The inner loops of the numeric rooms, which get what
    # was checked here, are spared.
    target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
  endif()
  if(ARG_READS_FILES)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:dynasurf_text_flags> $<BUILD_INTERFACE:dynasurf_light_flags>)
  endif()
  dynasurf_precompile_module(${target} ${ARG_READS_FILES})
  list(TRANSFORM ARG_ALONE REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/src/dynasurf/${name}/\\1.cpp")
  dynasurf_join_sources(${target} ${ARG_ALONE})
  add_library(dynasurf::${name} ALIAS ${target})
  set(dynasurf_modules ${dynasurf_modules} ${target} PARENT_SCOPE)
endfunction()

# dynasurf_tell_version(target): app/version.hpp for it. The commit is looked up at every build, and the target is
# compiled anew only when it changed.
function(dynasurf_tell_version target)
  set(source ${PROJECT_BINARY_DIR}/version.cpp)
  if(NOT TARGET dynasurf_version)
    add_custom_target(dynasurf_version
      BYPRODUCTS ${source}
      COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DOUTPUT=${source} -DVERSION=${PROJECT_VERSION}
              -P ${PROJECT_SOURCE_DIR}/cmake/version.cmake
      VERBATIM)
  endif()
  add_dependencies(${target} dynasurf_version)
  set_source_files_properties(${source} PROPERTIES GENERATED TRUE)
  target_sources(${target} PRIVATE ${source})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/app)
endfunction()

# dynasurf_light_test_code(target [header...]): the flags of tests, and what the first target with these headers
# precompiled. Such code spends its time in the libraries; optimising it would only make it slower to build.
function(dynasurf_light_test_code target)
  target_link_libraries(${target} PRIVATE dynasurf_flags dynasurf_text_flags)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(DYNASURF_PRECOMPILE)
    string(MAKE_C_IDENTIFIER "dynasurf_precompiled_tests_${ARGN}" property)
    get_property(first GLOBAL PROPERTY ${property})
    if(first)
      target_precompile_headers(${target} REUSE_FROM ${first})
    else()
      dynasurf_precompile(${target} ${ARGN})
      set_property(GLOBAL PROPERTY ${property} ${target})
    endif()
  endif()
endfunction()

# dynasurf_test(name LIBRARIES ...): a GoogleTest program from tests/<name>/*.cpp; every case is one ctest test.
function(dynasurf_test name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} GTest::gmock GTest::gtest_main)
  dynasurf_light_test_code(test_${name} <gmock/gmock.h> <gtest/gtest.h>)
  dynasurf_join_sources(test_${name})
  set(limit 300)
  if(DYNASURF_SANITIZE)
    set(limit 1800)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX "${name}/" PROPERTIES TIMEOUT ${limit} DISCOVERY_TIMEOUT 60)
endfunction()
