#include "tafoni/landforms/measures.h"

namespace tafoni::landforms {
namespace {

constexpr const char *productions = "productions", *classic = "classic", *morphic = "morphic",
                     *elements = "elements", *size = "size", *detail = "detail", *low = "low", *high = "high";

}  // namespace

Facts facts_of(const GrammarCaveMeasures& m) {
  Facts facts;
  facts.count(productions, m.productions())
      .about("Rules of the grammar that were applied, classic and morphic")
      .count(classic, m.classic)
      .about("Productions that put one more solid to the shape")
      .count(morphic, m.morphic)
      .about("Productions that blend a solid into the shape")
      .count(elements, m.elements)
      .about("Solids that the shape is made of")
      .length(size, m.size)
      .about("Half the width of a middling shape")
      .count(detail, m.detail)
      .about("Samples a size, L_D")
      .places(low, {m.box.lo})
      .about("Least x, y and z of the box that holds the shape")
      .places(high, {m.box.hi})
      .about("Greatest x, y and z of the box that holds the shape")
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
