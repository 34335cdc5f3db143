# SPDX-License-Identifier: Apache-2.0
# How every target of this repository is built. One folder is one library: dts_library(core log.cpp ...) in daemon/core
# makes the target dts_core, whose includes start at daemon/ ("core/log.h").

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# -Wno-restrict: g++ 12 warns falsely about std::string operator+ (GCC bug 105651).
set(DTS_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    -Wno-missing-field-initializers)  # designated initialisers leave out what keeps its default: that is their point
set(DTS_SANITIZE "" CACHE STRING "Sanitizers to build with, as for -fsanitize=")
if(DTS_SANITIZE)
  add_compile_options(-fsanitize=${DTS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${DTS_SANITIZE})
endif()

function(dts_library name)
  add_library(dts_${name} STATIC ${ARGN})
  target_include_directories(dts_${name} PUBLIC ${CMAKE_SOURCE_DIR}/daemon)
  target_compile_options(dts_${name} PRIVATE ${DTS_WARNINGS})
endfunction()

function(dts_program name)
  add_executable(${name} ${ARGN})
  target_compile_options(${name} PRIVATE ${DTS_WARNINGS})
endfunction()

# GoogleTest's headers are a third of what compiling a test costs. Read once where everything is built from nothing (CI); off elsewhere,
# since ccache does better without.
option(DTS_PRECOMPILED_TEST_HEADERS "Precompile the headers that most tests include" OFF)

function(dts_precompile_test_headers name)
  if(NOT DTS_PRECOMPILED_TEST_HEADERS)
    return()
  endif()
  if(NOT TARGET dts_test_headers)
    if(NOT EXISTS ${CMAKE_BINARY_DIR}/dts_test_headers.cpp)
      file(WRITE ${CMAKE_BINARY_DIR}/dts_test_headers.cpp "")
    endif()
    add_library(dts_test_headers OBJECT ${CMAKE_BINARY_DIR}/dts_test_headers.cpp)
    get_target_property(options ${name} COMPILE_OPTIONS)
    target_compile_options(dts_test_headers PRIVATE ${options})
    target_link_libraries(dts_test_headers PRIVATE GTest::gtest GTest::gmock)
    target_precompile_headers(dts_test_headers PRIVATE
      <algorithm> <filesystem> <fstream> <functional> <map> <memory> <optional> <string> <variant> <vector> <gmock/gmock.h> <gtest/gtest.h>)
  endif()
  target_precompile_headers(${name} REUSE_FROM dts_test_headers)
endfunction()

# dts_test(NAME label LIBRARIES ... SOURCES ...): a GoogleTest program in build/<preset>/tests, its cases under one ctest label.
function(dts_test name label)
  cmake_parse_arguments(TEST "" "TIMEOUT" "SOURCES;LIBRARIES;ENVIRONMENT" ${ARGN})
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 120)
  endif()
  add_executable(${name} ${TEST_SOURCES})
  # What is tested is optimised, the tests themselves need not be: -O1 compiles a quarter faster than -O3.
  target_compile_options(${name} PRIVATE ${DTS_WARNINGS} $<$<CONFIG:Release>:-O1>)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE DTS_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${TEST_LIBRARIES} GTest::gtest GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  dts_precompile_test_headers(${name})
  # libzmq is not instrumented: without the first setting every hand-over inside it reads as a race.
  set(sanitizer_options "TSAN_OPTIONS=ignore_noninstrumented_modules=1:halt_on_error=1")
  set(environment "${sanitizer_options};${TEST_ENVIRONMENT}")
  if(DTS_SANITIZE AND label MATCHES "unit|contract")
    # A thousand starts of a sanitizer's run-time are minutes: one process for all cases of such a program.
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 600 ENVIRONMENT "${environment}")
  else()
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
      PROPERTIES LABELS ${label} TIMEOUT ${TEST_TIMEOUT} ENVIRONMENT "${environment}")
  endif()
endfunction()
