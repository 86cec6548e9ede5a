#include "tafoni/grammar/solid.h"

#include "tafoni/core/error.h"

namespace tafoni::grammar {

const SolidType& find_solid(std::string_view name) {
  std::vector<std::string> names;
  for (const SolidType* type : all_solids()) {
    if (type->name == name) return *type;
    names.push_back(type->name);
  }
  const std::string near = nearest(name, names);
  if (near.empty()) fail(ErrorKind::usage, "unknown solid \"{}\"; see `tafoni list solids`", name);
  fail(ErrorKind::usage, "unknown solid \"{}\"; did you mean \"{}\"?", name, near);
}

}  // namespace tafoni::grammar
