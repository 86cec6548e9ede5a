// Reads a table of rules once into terms with compiled expressions, then derives: symbols wait in a queue,
// and each is replaced by one of its rules, drawn by weights that may depend on the rock where it stands.

#include "tafoni/landforms/hoodoos/growth.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tafoni/core/error.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::impl {
namespace {

enum class GrowthStream : std::uint64_t { choices = 0x6772 };

// A hoodoo that anyone can mean stays far below; a rule that does not end passes them within a blink.
constexpr std::size_t most_symbols = 20000;
constexpr int deepest_growth = 1000;
constexpr double most_repeats = 1000;
// What is made counts also where it is too small to stay, and so does each step of an expression: a tenth of
// a second.
constexpr double most_made = 200000;
constexpr std::size_t most_steps = 20'000'000;

/// What expressions can read: a derivation's values by place, and their names.
struct Read {
  enum : std::size_t { s, a, b, c, i, n, rho, h, bed, z, depth, height, radius, skin };
};
constexpr std::string_view variables[] = {"s", "a",   "b", "c",     "i",      "n",      "rho",
                                          "h", "bed", "z", "depth", "height", "radius", "skin"};
constexpr std::string_view inherited[] = {"s", "a", "b", "c"};
const ExpressionNames names{variables, "rho"};

Expression compile(Scanner& text) {
  return Expression::compile(text, names);
}

Expression inherit(std::string_view variable) {
  Scanner text(variable, {});
  return compile(text);
}

}  // namespace

std::vector<ParamInfo> rule_columns() {
  return {
      column("symbol", "", "What the rule replaces: a name of letters and digits"),
      column("weight", "1",
             "Chance among the rules of the same symbol, an expression; a rule of 0 or less is never taken"),
      column("make", "",
             "What takes its place, as NAME(ARGUMENT = EXPRESSION, ...), with ; between one and the next")};
}

GrowthRules::GrowthRules(const Rows& rules, std::string_view where) : where_(where) {
  const auto cell = [](const Row& row, std::string_view column) {
    const auto found = row.find(column);
    return found == row.end() ? std::string_view() : std::string_view(found->second);
  };
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const std::string_view name = cell(rules[i], "symbol");
    Scanner text(name, fmt::format("{}: rule {}, symbol", where, i + 1));
    if (text.name() != name || name.empty()) text.error(1, "a symbol is a name of letters and digits");
    if (!has(name)) symbols_.push_back({std::string(name), {}});
  }
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const std::string_view name = cell(rules[i], "symbol");
    add_rule(name, cell(rules[i], "weight"), cell(rules[i], "make"),
             fmt::format("{}: rule {} ({})", where, i + 1, name));
  }
}

void GrowthRules::add_rule(std::string_view symbol, std::string_view weight, std::string_view make,
                           std::string_view where) {
  Rule rule;
  rule.where = where;
  Scanner weight_text(weight, rule.where + ", weight");
  rule.weight = compile(weight_text);
  if (!weight_text.at_end())
    weight_text.error(fmt::format("\"{}\" is not expected here", weight_text.peek()));
  Scanner make_text(make, rule.where + ", make");
  while (!make_text.at_end()) {
    rule.terms.push_back(term(make_text));
    if (!make_text.at_end()) make_text.expect(";");
  }
  symbols_[find(symbol)].rules.push_back(std::move(rule));
}

int GrowthRules::find(std::string_view symbol) const {
  const auto found =
      std::find_if(symbols_.begin(), symbols_.end(), [&](const Symbol& s) { return s.name == symbol; });
  return found == symbols_.end() ? -1 : static_cast<int>(found - symbols_.begin());
}

std::vector<std::string> GrowthRules::symbols() const {
  std::vector<std::string> out;
  for (const Symbol& s : symbols_) out.push_back(s.name);
  return out;
}

GrowthRules::Term GrowthRules::term(Scanner& text) const {
  Term term;
  term.column = text.column();
  const std::string_view name = text.name();
  if (name.empty()) text.error(term.column, "a symbol or a primitive is missing");
  term.symbol = find(name);
  if (term.symbol >= 0) {
    for (std::string_view variable : inherited) term.sizes.push_back(inherit(variable));
  } else {
    std::vector<std::string> known = symbols();
    for (const field::PrimitiveType* kind : field::all_primitives()) {
      if (kind->variable) continue;
      known.push_back(kind->about.name);
      if (kind->about.name == name) term.kind = kind;
    }
    if (!term.kind) {
      const std::string near = nearest(name, known);
      text.error(term.column, fmt::format("\"{}\" is neither a symbol nor a primitive{}", name,
                                          near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    }
    for (const ParamInfo& info : term.kind->about.params)
      term.sizes.emplace_back(std::get<double>(info.init));
  }
  if (!text.take("(")) return term;
  if (text.take(")")) return term;
  do read_argument(text, term, name);
  while (text.take(","));
  text.expect(")");
  return term;
}

void GrowthRules::read_argument(Scanner& text, Term& term, std::string_view of) const {
  const std::size_t column = text.column();
  const std::string_view given = text.name();
  Expression* into = argument(term, given);
  if (!into) {
    std::vector<std::string> known = {"x", "y", "z", "turn", "repeat"};
    if (term.kind) {
      known.emplace_back("energy");
      for (const ParamInfo& info : term.kind->about.params) known.push_back(info.name);
    } else {
      known.insert(known.end(), std::begin(inherited), std::end(inherited));
    }
    if (given.empty())
      text.error(column, fmt::format("{}( is to be closed, or an argument is to be named", of));
    // A kind may have a turn of its own.
    std::vector<std::string> once;
    for (const std::string& k : known)
      if (std::find(once.begin(), once.end(), k) == once.end()) once.push_back(k);
    std::string all;
    for (const std::string& k : once) all += (all.empty() ? "" : ", ") + k;
    text.error(column, fmt::format("{} has no argument \"{}\"; it has {}", of, given, all));
  }
  text.expect("=");
  *into = compile(text);
}

Expression* GrowthRules::argument(Term& term, std::string_view name) const {
  if (name == "repeat") return &term.repeat;
  if (name == "x") return &term.x;
  if (name == "y") return &term.y;
  if (name == "z") return &term.z;
  if (name == "turn") return &term.turn;
  if (term.kind) {
    if (name == "energy") return &term.energy;
    for (std::size_t k = 0; k < term.kind->about.params.size(); ++k)
      if (term.kind->about.params[k].name == name) return &term.sizes[k];
  } else {
    for (std::size_t k = 0; k < std::size(inherited); ++k)
      if (inherited[k] == name) return &term.sizes[k];
  }
  return nullptr;
}

/// One derivation. Symbols are replaced in the order in which they come up.
class Derivation {
 public:
  Derivation(const GrowthRules& rules, const Axiom& axiom, const Surroundings& surroundings)
      : rules_(rules), axiom_(axiom), around_(surroundings), random_(axiom.seed, GrowthStream::choices) {}

  std::vector<Terminal> run(int symbol) {
    const double s = axiom_.radius;
    queue_.push_back({symbol, axiom_.position, axiom_.turn, {s, 0, 0, 0}, 0});
    for (std::size_t next = 0; next < queue_.size(); ++next) {
      const Place at = queue_[next];
      if (around_.allowed(at.position)) replace(at);
    }
    return std::move(out_);
  }

 private:
  struct Place {
    int symbol;
    Vec3d position;
    double turn;
    std::array<double, 4> sizes;
    int depth;
  };

  void replace(const Place& at) {
    const GrowthRules::Symbol& symbol = rules_.symbols_[at.symbol];
    probe_ = [&](double dz) { return around_.resistance(at.position + Vec3d{0, 0, dz}); };
    std::copy(at.sizes.begin(), at.sizes.end(), values_.begin());
    set_repeat(0, 1);
    values_[Read::rho] = around_.resistance(at.position);
    values_[Read::h] = at.position.z - around_.ground(at.position);
    values_[Read::bed] = around_.bed(at.position);
    values_[Read::z] = at.position.z + axiom_.datum;
    values_[Read::depth] = at.depth;
    values_[Read::height] = axiom_.height;
    values_[Read::radius] = axiom_.radius;
    values_[Read::skin] = axiom_.skin;
    const GrowthRules::Rule* rule = choose(symbol);
    if (!rule) return;
    for (const GrowthRules::Term& term : rule->terms) {
      set_repeat(0, 1);
      const double n = std::floor(finite(*rule, term, "repeat", run(term.repeat)));
      if (n > most_repeats)
        fail(ErrorKind::usage, "{}, make, column {}: repeat = {} is more than {}", rule->where, term.column,
             n, most_repeats);
      made_ += std::max(n, 0.0);
      if (made_ > most_made)
        fail(ErrorKind::usage, "{}, make, column {}: more than {} shapes in one hoodoo; let it repeat less",
             rule->where, term.column, most_made);
      for (double i = 0; i < n; ++i) {
        set_repeat(i, n);
        make(at, *rule, term);
      }
    }
  }

  const GrowthRules::Rule* choose(const GrowthRules::Symbol& symbol) {
    double total = 0;
    weights_.clear();
    for (const GrowthRules::Rule& rule : symbol.rules) {
      check_steps(rule);
      const double w = run(rule.weight);
      if (!std::isfinite(w))
        fail(ErrorKind::usage, "{}, weight: its value is not a finite number", rule.where);
      weights_.push_back(std::max(w, 0.0));
      total += weights_.back();
    }
    if (total <= 0) return nullptr;
    double left = total * random_.uniform();
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      left -= weights_[i];
      if (left < 0 && weights_[i] > 0) return &symbol.rules[i];
    }
    for (std::size_t i = weights_.size(); i-- > 0;)
      if (weights_[i] > 0) return &symbol.rules[i];
    return nullptr;
  }

  void make(const Place& at, const GrowthRules::Rule& rule, const GrowthRules::Term& term) {
    check_steps(rule);
    const double turn = at.turn + degree * finite(rule, term, "turn", run(term.turn));
    const double x = finite(rule, term, "x", run(term.x)), y = finite(rule, term, "y", run(term.y));
    const double z = finite(rule, term, "z", run(term.z));
    const double c = std::cos(turn), s = std::sin(turn);
    const Vec3d position = at.position + Vec3d{c * x - s * y, s * x + c * y, z};
    if (term.kind) return terminal(position, turn, rule, term);
    Place next{term.symbol, position, turn, {}, at.depth + 1};
    for (std::size_t k = 0; k < next.sizes.size(); ++k)
      next.sizes[k] = finite(rule, term, inherited[k], run(term.sizes[k]));
    check_end(rule, queue_.size() + out_.size(), next.depth);
    queue_.push_back(next);
  }

  void terminal(Vec3d position, double turn, const GrowthRules::Rule& rule, const GrowthRules::Term& term) {
    Terminal t{term.kind, position, finite(rule, term, "energy", run(term.energy)), {}};
    const auto& params = term.kind->about.params;
    std::array<double, Terminal::most> sizes{};
    std::size_t east = params.size(), north = params.size();
    for (std::size_t k = 0; k < params.size(); ++k) {
      sizes[k] = finite(rule, term, params[k].name, run(term.sizes[k]));
      if (params[k].name == "dx") east = k;
      if (params[k].name == "dy") north = k;
      // The shape's own turn is that of its symbol.
      if (params[k].name == "turn") sizes[k] = std::remainder(turn / degree, 360);
    }
    // A direction turns with its symbol.
    if (east < params.size() && north < params.size()) {
      const double c = std::cos(turn), s = std::sin(turn), x = sizes[east], y = sizes[north];
      sizes[east] = c * x - s * y;
      sizes[north] = s * x + c * y;
    }
    for (std::size_t k = 0; k < params.size(); ++k) {
      if (sizes[k] > params[k].max)
        fail(ErrorKind::usage, "{}, make, column {}: {} = {:.6g} is above {:g}", rule.where, term.column,
             params[k].name, sizes[k], params[k].max);
      if (sizes[k] < params[k].min) return;
      t.shape[k] = static_cast<float>(sizes[k]);
    }
    check_end(rule, queue_.size() + out_.size(), 0);
    if (t.energy != 0 && around_.allowed(position)) out_.push_back(t);
  }

  /// Fails where growth has become more than anyone can mean.
  void check_end(const GrowthRules::Rule& rule, std::size_t symbols, int depth) const {
    if (symbols < most_symbols && depth < deepest_growth) return;
    fail(ErrorKind::usage,
         "{} does not come to an end: {} in one hoodoo; let its weight become 0 somewhere, as with \"h < "
         "height\"",
         rule.where,
         depth >= deepest_growth ? fmt::format("{} generations", deepest_growth)
                                 : fmt::format("{} symbols", most_symbols));
  }

  void check_steps(const GrowthRules::Rule& rule) const {
    if (steps_ <= most_steps) return;
    fail(ErrorKind::usage, "{}: takes too long to work out; write shorter expressions, or fewer rules",
         rule.where);
  }

  double run(const Expression& expression) {
    steps_ += expression.steps();
    return expression({values_, &random_, &probe_});
  }

  static double finite(const GrowthRules::Rule& rule, const GrowthRules::Term& term, std::string_view what,
                       double value) {
    if (std::isfinite(value)) return value;
    fail(ErrorKind::usage, "{}, make, column {}: {} is not a finite number", rule.where, term.column, what);
  }

  /// The i-th of n repeats.
  void set_repeat(double i, double n) {
    values_[Read::i] = i;
    values_[Read::n] = n;
  }

  const GrowthRules& rules_;
  const Axiom& axiom_;
  const Surroundings& around_;
  Random random_;
  std::array<double, std::size(variables)> values_{};
  std::function<double(double)> probe_;
  std::vector<double> weights_;
  double made_ = 0;
  std::size_t steps_ = 0;
  std::vector<Place> queue_;
  std::vector<Terminal> out_;
};

std::vector<Terminal> GrowthRules::grow(std::string_view symbol, const Axiom& axiom,
                                        const Surroundings& surroundings) const {
  const int start = find(symbol);
  if (start < 0) {
    const std::string near = nearest(symbol, symbols());
    fail(ErrorKind::usage, "{}: no rule has the symbol \"{}\"{}", where_, symbol,
         near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near));
  }
  return Derivation(*this, axiom, surroundings).run(start);
}

}  // namespace tafoni::landforms::impl
