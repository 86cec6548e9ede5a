# One file per entry: DIR/<name>.cpp, or DIR/<name>/<name>.cpp for one that has a folder, defines
# `const TYPE& KIND_<name>()` ('-' in the file name reads '_'). The files themselves belong to TARGET already.
# Writes a table of every entry, sorted by name, so that adding an entry edits no other file.
# The table is all_<kind>s(), or all_<PLURAL>() where a seventh argument gives the plural.
# (Objects that register themselves from a static initialiser are dropped by a static library.)
function(tafoni_registry target kind dir header ns type)
  file(GLOB files RELATIVE ${CMAKE_SOURCE_DIR}/${dir} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${dir}/*.cpp)
  file(GLOB folders RELATIVE ${CMAKE_SOURCE_DIR}/${dir} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${dir}/*/*.cpp)
  set(names "")
  foreach(file IN LISTS files folders)
    get_filename_component(name ${file} NAME_WE)
    get_filename_component(folder ${file} DIRECTORY)
    if(folder STREQUAL "" OR folder STREQUAL name)
      list(APPEND names ${name})
    endif()
  endforeach()
  list(REMOVE_ITEM names ${kind}) # DIR/<kind>.cpp is what all entries share
  list(SORT names)
  set(plural ${kind}s)
  if(ARGC GREATER 6)
    set(plural ${ARGV6})
  endif()
  set(declarations "")
  set(entries "")
  foreach(name IN LISTS names)
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
  target_sources(${target} PRIVATE ${generated})
endfunction()
