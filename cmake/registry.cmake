# What the entries of DIR... are called: DIR/<name>.cpp, or DIR/<name>/<name>.cpp for one that has a folder.
# Sets OUT to the names, sorted; DIR/<kind>.cpp is what all entries share.
function(tafoni_entries out kind)
  set(names "")
  foreach(dir IN LISTS ARGN)
    file(GLOB files RELATIVE ${CMAKE_SOURCE_DIR}/${dir} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${dir}/*.cpp)
    file(GLOB folders RELATIVE ${CMAKE_SOURCE_DIR}/${dir} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${dir}/*/*.cpp)
    foreach(file IN LISTS files folders)
      get_filename_component(name ${file} NAME_WE)
      get_filename_component(folder ${file} DIRECTORY)
      if(folder STREQUAL "" OR folder STREQUAL name)
        list(APPEND names ${name})
      endif()
    endforeach()
  endforeach()
  list(REMOVE_ITEM names ${kind})
  list(SORT names)
  set(${out} ${names} PARENT_SCOPE)
endfunction()

# One file per entry defines `const TYPE& declaration()` in the namespace NS::KIND_<name> ('-' in the file name
# reads '_'), which makes the names in it its own. The files themselves belong to TARGET already. Writes a table of every entry, sorted by name, so that adding an entry edits no
# other file. DIR may be a list of folders.
# The table is all_<kind>s(), or all_<PLURAL>() where a seventh argument gives the plural.
# (Objects that register themselves from a static initialiser are dropped by a static library.)
function(tafoni_registry target kind dir header ns type)
  tafoni_entries(names ${kind} ${dir})
  set(plural ${kind}s)
  if(ARGC GREATER 6)
    set(plural ${ARGV6})
  endif()
  set(declarations "")
  set(entries "")
  foreach(name IN LISTS names)
    string(REPLACE "-" "_" id ${name})
    string(APPEND declarations "namespace ${kind}_${id} {\nconst ${type}& declaration();\n}\n")
    string(APPEND entries "    &${kind}_${id}::declaration(),\n")
  endforeach()
  set(generated ${CMAKE_BINARY_DIR}/generated/${kind}_registry.cpp)
  file(CONFIGURE OUTPUT ${generated} CONTENT "// Written by cmake/registry.cmake.
#include \"${header}\"

namespace ${ns} {
${declarations}
std::span<const ${type}* const> all_${plural}() {
  static const ${type}* const table[] = {
${entries}  };
  return table;
}
}  // namespace ${ns}
")
  target_sources(${target} PRIVATE ${generated})
endfunction()

# Entries with a kernel for every instruction set. DIR/<name>.cpp has two parts: under `#if TAFONI_KERNELS` a
# struct <Name> ('cone-sphere' reads ConeSphere), and its declaration. Neither is compiled by itself: COUNT
# entries at a time make one generated source, which includes their structs once for every instruction set
# inside of NS::HWY_NAMESPACE, has `TABLE make_kernels<Name>()` of INLINES fill a table from each, gives the
# one that this machine shall use as `const TABLE& NS::<name>_kernels()`, and includes the declarations. So
# entries hold no more than is theirs, and Highway is read once for many of them.
function(tafoni_kernels target kind dir inlines ns table count)
  tafoni_entries(names ${kind} ${dir})
  list(LENGTH names last)
  math(EXPR last "(${last} - 1) / ${count}")
  foreach(unit RANGE ${last})
    math(EXPR first "${unit} * ${count}")
    list(SUBLIST names ${first} ${count} here)
    set(includes "")
    set(makers "")
    set(tables "")
    foreach(name IN LISTS here)
      string(REPLACE "-" "_" id ${name})
      string(REGEX MATCHALL "[a-z0-9]+" words ${name})
      set(struct "")
      foreach(word IN LISTS words)
        string(SUBSTRING ${word} 0 1 initial)
        string(SUBSTRING ${word} 1 -1 rest)
        string(TOUPPER ${initial} initial)
        string(APPEND struct ${initial}${rest})
      endforeach()
      string(REGEX REPLACE "^src/" "" path ${dir}/${name}.cpp)
      set_source_files_properties(${dir}/${name}.cpp PROPERTIES HEADER_FILE_ONLY ON)
      string(APPEND includes "#include \"${path}\"\n")
      string(APPEND makers "${table} make_${id}() { return make_kernels<${struct}>(); }\n")
      string(APPEND tables "HWY_EXPORT(make_${id});
const ${table}& ${id}_kernels() {
  static const ${table} table = HWY_DYNAMIC_DISPATCH(make_${id})();
  return table;
}
")
    endforeach()
    set(generated ${CMAKE_BINARY_DIR}/generated/${kind}_kernels_${unit}.cpp)
    file(CONFIGURE OUTPUT ${generated} CONTENT "// Written by cmake/registry.cmake.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE \"${generated}\"
#include <hwy/foreach_target.h>
// foreach_target must come before what it compiles again.
#include \"${inlines}\"

HWY_BEFORE_NAMESPACE();
namespace ${ns} {
namespace HWY_NAMESPACE {
#undef TAFONI_KERNELS
#define TAFONI_KERNELS 1
${includes}
${makers}
}  // namespace HWY_NAMESPACE
}  // namespace ${ns}
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ${ns} {
${tables}}  // namespace ${ns}
#undef TAFONI_KERNELS
#define TAFONI_KERNELS 0
${includes}#endif
")
    set_source_files_properties(${generated} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    target_sources(${target} PRIVATE ${generated})
  endforeach()
endfunction()
