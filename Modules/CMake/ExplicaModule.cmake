# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# A module is a folder with include/Explica/<Name>, src, test, benchmark and one call of
# explica_add_module: its purpose, its dependencies and its sources, each said once.  Every file of
# include/Explica/<Name> is a public header: installed, and compiled alone by `check_headers`.  Every
# *Test.cpp of test is a unit test, unless it is named as another kind, and every file of benchmark
# a benchmark: an executable of its own, with Google Benchmark.

# explica_add_module(<Name>
#   PURPOSE "one sentence"
#   COMPILE_QUICKLY             nothing in it is worth the compiler's full effort
#   SOURCES src/...             compiled into the static library Explica::<Name>
#   PUBLIC  target...           links that a public header needs
#   PRIVATE target...           all other links
#   FIND    "Package ARGS"...   what a consumer's CMake must find for these links
#   PROPERTY_TESTS test/...     GoogleTest sources by CTest label; those of a label are one executable
#   SLOW_TESTS test/...
#   OTHER_TESTS test/...        sources of executables that the module adds itself
#   TEST_LINKS target...)       extra links of tests and benchmarks
function(explica_add_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "COMPILE_QUICKLY" "PURPOSE"
    "SOURCES;PUBLIC;PRIVATE;FIND;PROPERTY_TESTS;SLOW_TESTS;OTHER_TESTS;TEST_LINKS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_PURPOSE OR NOT arg_SOURCES)
    message(FATAL_ERROR "explica_add_module(${name}): PURPOSE and SOURCES are needed; "
      "not understood: '${arg_UNPARSED_ARGUMENTS}'")
  endif()

  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} include/Explica/${name}/*.h)
  set(target Explica${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(Explica::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${headers})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  explica_set_flags(${target})
  explica_compile_in_batches(${target} 8)
  if(arg_COMPILE_QUICKLY)
    explica_compile_quickly(${target})
    explica_use_precompiled_headers(${target} Quick)
  else()
    explica_use_precompiled_headers(${target} Library)
  endif()

  install(TARGETS ${target} EXPORT Explica${name}Targets
    FILE_SET HEADERS COMPONENT development
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT Explica${name}Targets NAMESPACE Explica::
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Explica COMPONENT development)
  set(needed "")
  foreach(link IN LISTS arg_PUBLIC arg_PRIVATE)
    if(link MATCHES "^Explica::(.+)$")
      list(APPEND needed ${CMAKE_MATCH_1})
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY EXPLICA_MODULES ${name})
  set_property(GLOBAL PROPERTY EXPLICA_${name}_NEEDS "${needed}")
  set_property(GLOBAL PROPERTY EXPLICA_${name}_FIND "${arg_FIND}")

  # Every public header must compile alone.
  set(header_sources "")
  foreach(header IN LISTS headers)
    string(REGEX REPLACE "^include/" "" path "${header}")
    string(MAKE_C_IDENTIFIER "${path}" id)
    set(source "${CMAKE_CURRENT_BINARY_DIR}/headers/${id}.cpp")
    file(CONFIGURE OUTPUT "${source}" CONTENT "#include \"${path}\"\n")
    list(APPEND header_sources "${source}")
  endforeach()
  add_library(${target}Headers OBJECT EXCLUDE_FROM_ALL ${header_sources})
  target_link_libraries(${target}Headers PRIVATE Explica::${name})
  explica_set_flags(${target}Headers)
  if(NOT TARGET check_headers)
    add_custom_target(check_headers)
  endif()
  add_dependencies(check_headers ${target}Headers)

  if(EXPLICA_BUILD_TESTS)
    file(GLOB arg_UNIT_TESTS CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} test/*Test.cpp)
    list(REMOVE_ITEM arg_UNIT_TESTS ${arg_PROPERTY_TESTS} ${arg_SLOW_TESTS} ${arg_OTHER_TESTS})
    foreach(kind IN ITEMS UNIT PROPERTY SLOW)
      if(arg_${kind}_TESTS)
        string(TOLOWER ${kind} label)
        string(SUBSTRING ${label} 1 -1 rest)
        string(SUBSTRING ${kind} 0 1 first)
        explica_add_test_executable(${target}${first}${rest}Tests LABEL ${label}
          SOURCES ${arg_${kind}_TESTS} LINKS Explica::${name} ${arg_TEST_LINKS})
        explica_compile_in_batches(${target}${first}${rest}Tests 8)
      endif()
    endforeach()
  endif()

  if(EXPLICA_BUILD_BENCHMARKS)
    file(GLOB benchmarks CONFIGURE_DEPENDS benchmark/*.cpp)
    foreach(source IN LISTS benchmarks)
      get_filename_component(stem ${source} NAME_WE)
      add_executable(${target}${stem} ${source})
      target_link_libraries(${target}${stem} PRIVATE Explica::${name} ${arg_TEST_LINKS}
        benchmark::benchmark_main)
      target_compile_definitions(${target}${stem} PRIVATE
        EXPLICA_REAL_DATA="${EXPLICA_REAL_DATA}")
      explica_set_flags(${target}${stem})
    endforeach()
  endif()
endfunction()

# explica_add_test_executable(<target> LABEL unit|property|slow|command SOURCES ... LINKS ... WHOLE suite...)
# One GoogleTest executable. Its command and slow tests appear in CTest one by one, but for suites that are WHOLE,
# whose tests share what they are tried on; unit and property tests, most of which last less than a start of the
# executable, as one test.
function(explica_add_test_executable target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL" "SOURCES;LINKS;WHOLE")
  add_executable(${target} ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE ${arg_LINKS} GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE EXPLICA_REAL_DATA="${EXPLICA_REAL_DATA}")
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/Testing/include")
  explica_set_flags(${target})
  explica_compile_quickly(${target})
  explica_use_precompiled_headers(${target} Tests)
  if(arg_LABEL MATCHES "unit|property")
    add_test(NAME ${target} COMMAND ${target} --gtest_brief=1)
    set_tests_properties(${target} PROPERTIES LABELS ${arg_LABEL} TIMEOUT 600)
    return()
  endif()
  set(timeout 300)
  if(arg_LABEL STREQUAL "slow")
    set(timeout 600)
  endif()
  set(properties LABELS ${arg_LABEL} TIMEOUT ${timeout} SKIP_REGULAR_EXPRESSION "skipped: no real data")
  set(others "")
  foreach(suite IN LISTS arg_WHOLE)
    add_test(NAME ${suite} COMMAND ${target} --gtest_filter=${suite}.*)
    set_tests_properties(${suite} PROPERTIES ${properties})
    string(APPEND others ":${suite}.*")
  endforeach()
  gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST TEST_FILTER "-${others}" PROPERTIES ${properties})
endfunction()

# Writes and installs ExplicaConfig.cmake: find_package(Explica [COMPONENTS Module...]).
function(explica_install_package)
  include(CMakePackageConfigHelpers)
  get_property(modules GLOBAL PROPERTY EXPLICA_MODULES)
  set(EXPLICA_MODULE_LIST "${modules}")
  set(EXPLICA_MODULE_TABLE "")
  foreach(module IN LISTS modules)
    get_property(needs GLOBAL PROPERTY EXPLICA_${module}_NEEDS)
    get_property(finds GLOBAL PROPERTY EXPLICA_${module}_FIND)
    string(APPEND EXPLICA_MODULE_TABLE "set(_explica_${module}_needs \"${needs}\")\n")
    string(APPEND EXPLICA_MODULE_TABLE "set(_explica_${module}_find \"${finds}\")\n")
  endforeach()
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/Explica)
  configure_package_config_file("${PROJECT_SOURCE_DIR}/Modules/CMake/ExplicaConfig.cmake.in"
    "${PROJECT_BINARY_DIR}/ExplicaConfig.cmake" INSTALL_DESTINATION ${destination})
  write_basic_package_version_file("${PROJECT_BINARY_DIR}/ExplicaConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
  install(FILES "${PROJECT_BINARY_DIR}/ExplicaConfig.cmake"
    "${PROJECT_BINARY_DIR}/ExplicaConfigVersion.cmake"
    "${PROJECT_SOURCE_DIR}/Modules/CMake/FindISAL.cmake" DESTINATION ${destination}
    COMPONENT development)
endfunction()
