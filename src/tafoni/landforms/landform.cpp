#include "tafoni/landforms/landform.h"

#include "tafoni/core/error.h"

namespace tafoni::landforms {

field::NodePtr apply_to(const field::NodePtr& tree, const Result& result) {
  std::vector<field::NodePtr> children = {result.reshape ? result.reshape(tree) : tree};
  children.insert(children.end(), result.nodes.begin(), result.nodes.end());
  return field::blend(std::move(children));
}

const LandformType& find_landform(std::string_view name) {
  return find(all_landforms(), name, "landform");
}

}  // namespace tafoni::landforms
