# SPDX-License-Identifier: Apache-2.0
# How every target of this repository is built. One folder is one library: dts_library(core log.cpp ...) in daemon/core
# makes the target dts_core, whose includes start at daemon/ ("core/log.h"). All presets but debug compile two dozen files of a target
# as one: what stands in anonymous namespaces has a name of its own within its target.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

if(PROJECT_IS_TOP_LEVEL)  # another project decides itself
  find_program(CCACHE ccache)
endif()
if(PROJECT_IS_TOP_LEVEL AND CCACHE)
  # By the compiler's list of dependencies: without, every miss preprocesses first, which makes it a fifth longer. By paths below this folder:
  # what dts_plain names is compiled once for all presets.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1 CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} ${CCACHE})
endif()

# The same numbers on every processor: arm64 can multiply and add in one instruction, which rounds once instead of twice, and GCC uses it unless
# it is told not to. GCC also notes there, on correct code, that its version 10 has changed the way that some parameters are passed.
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-ffp-contract=off -Wno-psabi)
endif()

# -Wno-restrict: g++ 12 warns falsely about std::string operator+ (GCC bug 105651).
set(DTS_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wshadow $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    -Wno-missing-field-initializers)  # designated initialisers leave out what keeps its default: that is their point

set(DTS_SANITIZE "" CACHE STRING "Sanitizers to build with, as for -fsanitize=")
set(is_plain 1)
if(DTS_SANITIZE)
  set(is_plain $<BOOL:$<TARGET_PROPERTY:DTS_PLAIN>>)
  set(options -UNDEBUG -O0 -g1 -fsanitize=${DTS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  if(DTS_SANITIZE MATCHES "undefined")  # the address sanitizer sees the same faults
    list(APPEND options -fno-sanitize=null,object-size,vptr)
  endif()
  if(DTS_SANITIZE MATCHES "fuzzer")
    list(APPEND options -O1)
  elseif(DTS_SANITIZE MATCHES "undefined" AND NOT DTS_TESTS STREQUAL "all")  # a quarter of the compile time of record and gateway
    list(APPEND options -fno-sanitize=alignment,pointer-overflow)
  elseif(DTS_SANITIZE STREQUAL "thread")
    list(APPEND options -include ${PROJECT_SOURCE_DIR}/cmake/libprotobuf_layout.h)
  endif()
  # With sanitizers GCC warns falsely more often (its manual, -fsanitize); the other presets have seen the same lines.
  set(is_strict ${CMAKE_COMPILE_WARNING_AS_ERROR})
  set(CMAKE_COMPILE_WARNING_AS_ERROR OFF)
  add_compile_options("$<$<NOT:${is_plain}>:${options}>")
  add_compile_definitions($<$<NOT:${is_plain}>:DTS_SANITIZED>)
  add_link_options(-fsanitize=${DTS_SANITIZE})
endif()

# dts_plain(TARGET ...): even under sanitizers the very objects of the release build, which ccache has.
function(dts_plain)
  if(DTS_SANITIZE)
    set_target_properties(${ARGN} PROPERTIES DTS_PLAIN ON COMPILE_WARNING_AS_ERROR "${is_strict}")
  endif()
endfunction()

# dts_computes(TARGET ...): optimised even under sanitizers, for its tests compute for long. All else is not: -O0 compiles in half the time.
function(dts_computes)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE $<$<NOT:${is_plain}>:-O1>)
  endforeach()
endfunction()

# dts_waits(TARGET ...): -O1 in a release build, which compiles in two thirds of the time: what waits for people, files or the network.
function(dts_waits)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,${is_plain}>:-O1>)
  endforeach()
endfunction()

function(dts_library name)
  add_library(dts_${name} STATIC ${ARGN})
  target_include_directories(dts_${name} PUBLIC ${PROJECT_SOURCE_DIR}/daemon)
  target_compile_options(dts_${name} PRIVATE ${DTS_WARNINGS})
endfunction()

function(dts_program name)
  add_executable(${name} ${ARGN})
  target_compile_options(${name} PRIVATE ${DTS_WARNINGS})
endfunction()

# dts_by_name(PROGRAM): built only when a script names it, and by scripts/test --all.
function(dts_by_name program)
  if(NOT DTS_TESTS STREQUAL "all")
    set_target_properties(${program} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()

# dts_test(NAME label LIBRARIES ... SOURCES ...): a GoogleTest program in build/<preset>/tests, its cases under one ctest label.
function(dts_test name label)
  cmake_parse_arguments(TEST "" "TIMEOUT" "SOURCES;LIBRARIES;ENVIRONMENT" ${ARGN})
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 300)
  endif()
  add_executable(${name} ${TEST_SOURCES})
  # What is tested is optimised, the tests themselves need not be: -O0 compiles in two thirds of the time of -O1.
  target_compile_options(${name} PRIVATE ${DTS_WARNINGS} $<$<CONFIG:Release>:-O0>)
  # What is tested keeps it, apart from inline functions of headers that a test includes: the linker takes the test's copy. In GoogleTest's
  # templates it only costs time.
  if(DTS_SANITIZE MATCHES "undefined" AND NOT DTS_TESTS STREQUAL "all")
    target_compile_options(${name} PRIVATE -fno-sanitize=undefined)
  endif()
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(${name} PRIVATE DTS_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${TEST_LIBRARIES} GTest::gtest GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  # libzmq is not instrumented: without the first setting every hand-over inside it reads as a race.
  set(sanitizer_options "TSAN_OPTIONS=ignore_noninstrumented_modules=1:halt_on_error=1")
  set(environment "${sanitizer_options};${TEST_ENVIRONMENT}")
  if(label MATCHES "unit|contract")
    # One process for all cases of such a program: thousands of starts are minutes. GoogleTest names what fails.
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 900 ENVIRONMENT "${environment}")
  else()
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 300
      PROPERTIES LABELS ${label} TIMEOUT ${TEST_TIMEOUT} ENVIRONMENT "${environment}")
  endif()
endfunction()
