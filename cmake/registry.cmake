# One file per entry: DIR/<name>.cpp defines `const TYPE& KIND_<name>()` ('-' in the file name reads '_').
# Writes a table of every entry, sorted by name, so that adding an entry edits no other file.
# The table is all_<kind>s(), or all_<PLURAL>() where a seventh argument gives the plural.
# (Objects that register themselves from a static initialiser are dropped by a static library.)
function(tafoni_registry target kind dir header ns type)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${dir}/*.cpp)
  if(NOT sources)
    return()
  endif()
  list(SORT sources)
  set(plural ${kind}s)
  if(ARGC GREATER 6)
    set(plural ${ARGV6})
  endif()
  set(declarations "")
  set(entries "")
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME_WE)
    string(REPLACE "-" "_" id ${name})
    string(APPEND declarations "const ${type}& ${kind}_${id}();\n")
    string(APPEND entries "    &${kind}_${id}(),\n")
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
  target_sources(${target} PRIVATE ${sources} ${generated})
endfunction()
