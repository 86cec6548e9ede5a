// A fact's name, content and unit are written twice: for programs, with the unit in the key and world
// positions, and for people, with the unit behind the number and without lists.
#include "tafoni/scene/products/facts.h"

#include <algorithm>
#include <type_traits>

#include <fmt/core.h>

#include "tafoni/field/tree.h"

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

const char* symbol(landforms::Unit unit) {
  switch (unit) {
    case landforms::Unit::metres:
      return " m";
    case landforms::Unit::square_metres:
      return " m2";
    case landforms::Unit::cubic_metres:
      return " m3";
    case landforms::Unit::none:
      break;
  }
  return "";
}

/// The fact in which a layer counts its primitives itself.
constexpr std::string_view primitives = "primitives";

std::string shown(const landforms::Fact::Content& content) {
  if (const auto* text = std::get_if<std::string>(&content)) return *text;
  if (const auto* number = std::get_if<double>(&content)) return fmt::format("{:.6g}", *number);
  if (const auto* count = std::get_if<std::int64_t>(&content)) return fmt::format("{}", *count);
  return std::get<bool>(content) ? "true" : "false";
}

bool is_list(const landforms::Fact::Content& content) {
  return std::holds_alternative<std::vector<double>>(content) ||
         std::holds_alternative<landforms::Places>(content);
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

std::string facts_text(const landforms::Facts& facts) {
  std::string out;
  for (const landforms::Fact& fact : facts) {
    if (fact.name == primitives || is_list(fact.content)) continue;
    std::string words = fact.name;
    std::replace(words.begin(), words.end(), '_', ' ');
    out += fmt::format("{}{} {}{}", out.empty() ? "" : ", ", words, shown(fact.content), symbol(fact.unit));
  }
  return out;
}

std::int64_t primitives_of(const landforms::Result& made) {
  if (const auto* counted = made.facts.find<std::int64_t>(primitives)) return *counted;
  std::int64_t out = 0;
  for (const field::NodePtr& node : made.nodes) out += field::stats(node).primitives;
  return out;
}

}  // namespace tafoni::scene
