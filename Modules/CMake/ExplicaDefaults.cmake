# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Build-wide defaults: language level, build type, output folder, compiler cache, flags of every target.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/lib")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/lib")
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)

find_program(EXPLICA_CCACHE ccache)
if(EXPLICA_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER "${EXPLICA_CCACHE}")
  # Without these ccache passes over every file that uses a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros "CCACHE_IGNOREOPTIONS=--param=ggc-min-heapsize=*"
    "${EXPLICA_CCACHE}")
endif()

option(EXPLICA_BATCHES "Compile several sources of bindings, framework and what deals with JSON at once: half the \
work when all are built, more when one of them changes" ON)

# For targets whose time is spent compiling them rather than running them: tests, JSON, commands.
function(explica_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# Compiles the target's sources a few at a time: they share what templates they instantiate.  Names in their
# unnamed namespaces must differ.
function(explica_compile_in_batches target size)
  if(EXPLICA_BATCHES)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
    # Hidden implementations hold types of their file's unnamed namespace; in a batch that file counts as a header.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# GCC looks through its memory for what is free, and so through all precompiled headers, each time it has
# grown by as much as this (kB): a tenth of its time, for little.
function(explica_collect_garbage_seldom target)
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=400000>)
endfunction()

# Flags live on targets: call this for every library and executable of the project.
function(explica_set_flags target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 warns falsely inside std::string (its bug 105651)
    -ffp-contract=off  # equal bytes on machines with and without fused multiply-add
    $<$<BOOL:${EXPLICA_WARNINGS_AS_ERRORS}>:-Werror>)
  if(EXPLICA_SANITIZE)
    set(sanitizers address,undefined)
    if(EXPLICA_SANITIZE STREQUAL "thread")
      set(sanitizers thread)
    endif()
    target_compile_options(${target} PRIVATE -fsanitize=${sanitizers} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${sanitizers})
  endif()
  if(EXPLICA_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# Two thirds of a compilation are the headers of others, so these are compiled once for each set of
# flags.  Each source includes what it needs all the same: it also builds with
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON.
#   explica_precompile_headers(<kind> <header>...)            beside those that all kinds have
#   explica_use_precompiled_headers(<target> <kind>)
function(explica_precompile_headers kind)
  set(target ExplicaPrecompiled${kind})
  set(source "${PROJECT_BINARY_DIR}/precompiled/${kind}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "// The precompiled headers are all there is.\n")
  add_library(${target} OBJECT "${source}")
  target_link_libraries(${target} PRIVATE Eigen3::Eigen)
  explica_set_flags(${target})
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <atomic> <cmath> <cstdint> <cstdio> <filesystem> <fstream> <functional> <map>
    <memory> <mutex> <numeric> <optional> <random> <set> <span> <sstream> <string> <string_view>
    <unordered_map> <utility> <variant> <vector> <Eigen/Geometry> ${ARGN})
endfunction()

function(explica_use_precompiled_headers target kind)
  target_precompile_headers(${target} REUSE_FROM ExplicaPrecompiled${kind})
  explica_collect_garbage_seldom(${target})
  # The same false warnings inside std::string, under more names.
  foreach(warning IN ITEMS array-bounds maybe-uninitialized stringop-overflow stringop-overread)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-${warning}>)
  endforeach()
endfunction()
