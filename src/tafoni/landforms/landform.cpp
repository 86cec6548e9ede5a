#include "tafoni/landforms/landform.h"

namespace tafoni::landforms {

const LandformType& find_landform(std::string_view name) {
  std::vector<std::string> names;
  for (const LandformType* type : all_landforms()) {
    if (type->name == name) return *type;
    names.push_back(type->name);
  }
  const std::string near = nearest(name, names);
  if (near.empty()) fail(ErrorKind::usage, "unknown landform \"{}\"", name);
  fail(ErrorKind::usage, "unknown landform \"{}\"; did you mean \"{}\"?", name, near);
}

}  // namespace tafoni::landforms
