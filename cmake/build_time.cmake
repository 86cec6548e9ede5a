# What makes the build quick. More than half of a source's compile time is standard headers and templates that
# every source brings anew, so the sources of a module are compiled several at a time; and code that runs once
# a command needs no -O3. The preset `debug` compiles every source alone, with -Wshadow.

# Of which modules the Release build optimises less than -O3. Results do not depend on it: floating point is
# neither reordered nor fused. What fields are made of stays fast (grammar at -O1 costs half as much again when a
# grammar cave is meshed); what reads, writes and reports need not be.
set(level_of_core -O1)
set(level_of_terrain -O2)
set(level_of_geology -O2)
set(level_of_grammar -O2)
set(level_of_landforms -O2)
set(level_of_mesh -O2)
set(level_of_render -O2)
set(level_of_io -O1)
set(level_of_scene -O1)
set(level_of_runtime -O2)

# tafoni_build_together(TARGET [LEVEL]): its sources by about SIZE at a time, optimised to LEVEL.
set(sources_together 30)
function(tafoni_build_together target)
  if(ARGC GREATER 1 AND CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE ${ARGV1})
  endif()
  if(NOT TAFONI_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${sources_together})
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    # Kernels that are compiled once an instruction set include themselves.
    file(STRINGS ${source} kernels REGEX "HWY_TARGET_INCLUDE" LIMIT_COUNT 1)
    if(kernels)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
endfunction()

foreach(module IN LISTS modules)
  string(REPLACE tafoni_ "" name ${module})
  tafoni_build_together(${module} ${level_of_${name}})
endforeach()

# Tests spend their time in the library, and most of theirs is Google Test's headers: these are compiled once.
function(tafoni_build_test_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  # At -O1, g++ 12 sees copies beyond the end in std::string's own code, as with -Wrestrict above.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-stringop-overflow>)
  get_property(first GLOBAL PROPERTY TAFONI_FIRST_TEST)
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    set_property(GLOBAL PROPERTY TAFONI_FIRST_TEST ${target})
    target_precompile_headers(${target} PRIVATE <gmock/gmock.h> <gtest/gtest.h> <algorithm> <filesystem> <fstream>
                              <functional> <map> <optional> <set> <string> <variant> <vector> <fmt/core.h>)
  endif()
endfunction()
