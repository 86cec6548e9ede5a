#include "tafoni/scene/products/facts.h"

#include <type_traits>

namespace tafoni::scene {
namespace {

const char* suffix(landforms::Unit unit) {
  switch (unit) {
    case landforms::Unit::metres:
      return "_m";
    case landforms::Unit::square_metres:
      return "_m2";
    case landforms::Unit::cubic_metres:
      return "_m3";
    case landforms::Unit::none:
      break;
  }
  return "";
}

std::vector<double> world_numbers(const landforms::Places& places, Vec3d origin) {
  std::vector<double> out;
  for (const Vec3d& local : places.local) {
    const Vec3d world = local + origin;
    out.insert(out.end(), {world.x, world.y, world.z});
  }
  return out;
}

}  // namespace

std::pair<std::string, Value> report_entry(const landforms::Fact& fact, Vec3d origin) {
  const auto value = [origin](const auto& content) -> Value {
    if constexpr (std::is_same_v<std::decay_t<decltype(content)>, landforms::Places>)
      return world_numbers(content, origin);
    else
      return content;
  };
  return {fact.name + suffix(fact.unit), std::visit(value, fact.content)};
}

}  // namespace tafoni::scene
