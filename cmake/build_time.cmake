# What makes the build quick. More than half of a source's compile time is standard headers and templates that
# every source brings anew, so the sources of a module are compiled several at a time; and code that runs once
# a command needs no -O3. The preset `debug` compiles every source alone, with -Wshadow.

# Of which modules the Release build optimises less than -O3. Results do not depend on it: floating point is
# neither reordered nor fused. What reads, writes and reports need not be fast, nor what plans a landform once. A
# hive took a sixth longer with volumes at -O2, a canyon a tenth longer with fields, surfaces and terrain at -O2 or
# -O1, which saves a few seconds of compiling.
set(level_of_core -O1)
set(level_of_geology -O2)
set(level_of_grammar -O2)
set(level_of_landforms -Og)
set(level_of_render -O2)
set(level_of_io -O1)
set(level_of_scene -Og)
set(level_of_runtime -O1)

# What a mesh asks at every sample, or what goes over samples itself, is compiled at -O3 all the same: sources of
# the module in which the regular expression is found. (At -Og a grammar cave takes twice as long to mesh, and a
# canyon's streams a quarter longer to look for; the one function of a field in scene asks a grid, and is no slower.)
set(hot_in_landforms "field::Function|RockShape::|public RockShape|ScalarGrid|ChunkSamples|Outline::|SurfaceSample|parallel_for")

# tafoni_unit(TARGET NAME HEAD SOURCE...): compiles the sources as one, whose text begins with HEAD, in which
# @unit@ stands for the unit's own path.
function(tafoni_unit target name head)
  set(unit ${CMAKE_BINARY_DIR}/generated/${target}_${name}.cpp)
  string(CONFIGURE "${head}" text @ONLY)
  foreach(source IN LISTS ARGN)
    string(APPEND text "#include \"${source}\"\n")
  endforeach()
  file(CONFIGURE OUTPUT ${unit} CONTENT "// Written by cmake/build_time.cmake.\n${text}")
  target_sources(${target} PRIVATE ${unit})
  set_source_files_properties(${unit} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set_source_files_properties(${ARGN} PROPERTIES HEADER_FILE_ONLY ON)
endfunction()

# tafoni_build_together(TARGET [LEVEL [HOT]]): its sources by about 100 at a time, optimised to LEVEL in a Release
# build; those in which HOT is found, to -O3. Those with kernels make one unit, which Highway's foreach_target.h
# reads once for every instruction set. What a source is, is looked at when CMake configures.
set(kernels_head "#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \"@unit@\"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
")
function(tafoni_build_together target)
  get_target_property(sources ${target} SOURCES)
  set(kernels "")
  set(hot "")
  foreach(source IN LISTS sources)
    string(FIND "${source}" "${CMAKE_BINARY_DIR}/generated/" generated)
    if(generated EQUAL 0)
      continue()
    endif()
    file(STRINGS ${source} lines REGEX "HWY_BEFORE_NAMESPACE" LIMIT_COUNT 1)
    if(lines)
      list(APPEND kernels ${source})
    elseif(ARGC GREATER 2)
      file(STRINGS ${source} lines REGEX "${ARGV2}" LIMIT_COUNT 1)
      if(lines)
        list(APPEND hot ${source})
      endif()
    endif()
  endforeach()
  if(ARGC GREATER 1 AND CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE ${ARGV1})
    if(ARGV1 STREQUAL "-Og") # g++ knows too little of a value then
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    endif()
  else()
    set(hot "")
  endif()

  if(TAFONI_UNITY)
    set(batch 100)
    if(NOT CMAKE_BUILD_TYPE STREQUAL "Release") # sanitizers and debug information take memory
      set(batch 30)
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
    if(kernels)
      tafoni_unit(${target} kernels "${kernels_head}" ${kernels})
    endif()
    if(hot)
      tafoni_unit(${target} hot "" ${hot})
      set_source_files_properties(${CMAKE_BINARY_DIR}/generated/${target}_hot.cpp PROPERTIES COMPILE_OPTIONS -O3)
    endif()
    return()
  endif()
  foreach(source IN LISTS kernels)
    get_filename_component(name ${source} NAME_WE)
    tafoni_unit(${target} kernels_${name} "${kernels_head}" ${source})
  endforeach()
  if(hot)
    set_source_files_properties(${hot} PROPERTIES COMPILE_OPTIONS -O3)
  endif()
endfunction()

foreach(module IN LISTS modules)
  string(REPLACE tafoni_ "" name ${module})
  tafoni_build_together(${module} ${level_of_${name}} ${hot_in_${name}})
endforeach()
if(TAFONI_UNITY) # in one it would take 1.5 GB, and longer than all else on many cores
  set_target_properties(tafoni_io PROPERTIES UNITY_BUILD_BATCH_SIZE 30)
endif()

# Tests spend their time in the library. Most of what they take to compile is Google Test: its headers are compiled
# once, and its templates, which each source instantiates, for five sources together.
function(tafoni_build_test_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
  # At -Og, g++ 12 sees copies beyond the end in std::string's own code, as with -Wrestrict above.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-stringop-overflow>)
  if(TAFONI_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 5)
  endif()
  get_property(first GLOBAL PROPERTY TAFONI_FIRST_TEST)
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    set_property(GLOBAL PROPERTY TAFONI_FIRST_TEST ${target})
    target_precompile_headers(${target} PRIVATE <gmock/gmock.h> <gtest/gtest.h> <algorithm> <filesystem> <fstream>
                              <functional> <map> <optional> <set> <string> <variant> <vector> <fmt/core.h>)
  endif()
endfunction()
