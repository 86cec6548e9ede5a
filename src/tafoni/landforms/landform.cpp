#include "tafoni/landforms/landform.h"

#include "tafoni/core/error.h"

namespace tafoni::landforms {

const LandformType& find_landform(std::string_view name) {
  std::vector<std::string> known;
  for (const LandformType* type : all_landforms()) {
    if (type->name == name) return *type;
    known.push_back(type->name);
  }
  const std::string near = nearest(name, known);
  if (near.empty()) fail(ErrorKind::usage, "there is no landform \"{}\"; see tafoni list landforms", name);
  fail(ErrorKind::usage, "there is no landform \"{}\"; did you mean \"{}\"?", name, near);
}

}  // namespace tafoni::landforms
