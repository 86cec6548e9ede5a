#include "tafoni/landforms/measures.h"

namespace tafoni::landforms {
namespace {

constexpr const char *productions = "productions", *classic = "classic", *morphic = "morphic",
                     *elements = "elements", *size = "size", *detail = "detail", *low = "low", *high = "high";

}  // namespace

Facts facts_of(const GrammarCaveMeasures& m) {
  Facts facts;
  facts.count(productions, m.productions())
      .count(classic, m.classic)
      .count(morphic, m.morphic)
      .count(elements, m.elements)
      .length(size, m.size)
      .count(detail, m.detail)
      .places(low, {m.box.lo})
      .places(high, {m.box.hi})
      .count("primitives", 0);
  return facts;
}

std::optional<GrammarCaveMeasures> grammar_cave_measures(const Facts& facts) {
  const auto count = [&](const char* name) { return facts.find<std::int64_t>(name); };
  const auto* lo = facts.find<Places>(low);
  const auto* hi = facts.find<Places>(high);
  const auto* metres = facts.find<double>(size);
  if (!count(classic) || !count(morphic) || !count(elements) || !count(detail) || !metres || !lo || !hi)
    return std::nullopt;
  GrammarCaveMeasures m;
  m.classic = *count(classic);
  m.morphic = *count(morphic);
  m.elements = *count(elements);
  m.size = *metres;
  m.detail = *count(detail);
  m.box = {lo->local.at(0), hi->local.at(0)};
  return m;
}

}  // namespace tafoni::landforms
