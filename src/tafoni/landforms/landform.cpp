#include "tafoni/landforms/landform.h"

#include "tafoni/core/error.h"

namespace tafoni::landforms {

field::NodePtr applied(const field::NodePtr& tree, const Result& result) {
  std::vector<field::NodePtr> children = {result.reshape ? result.reshape(tree) : tree};
  children.insert(children.end(), result.nodes.begin(), result.nodes.end());
  return field::combine("blend", std::move(children));
}

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
