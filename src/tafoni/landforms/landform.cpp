#include "tafoni/landforms/landform.h"

#include <algorithm>
#include <limits>

#include "tafoni/core/error.h"

namespace tafoni::landforms {

field::NodePtr apply_to(const field::NodePtr& tree, const Result& result) {
  std::vector<field::NodePtr> children = {result.reshape ? result.reshape(tree) : tree};
  children.insert(children.end(), result.nodes.begin(), result.nodes.end());
  return field::blend(std::move(children));
}

double lowest_change(const Result& result) {
  if (result.lowest) return *result.lowest;
  double lowest = result.reshape ? result.reshaped.lo.z : std::numeric_limits<double>::infinity();
  for (const field::NodePtr& node : result.nodes) lowest = std::min(lowest, field::support(node).lo.z);
  return lowest;
}

const LandformType& find_landform(std::string_view name) {
  return find(all_landforms(), name, "landform");
}

}  // namespace tafoni::landforms
