// Assemblies by a table of rules: symbols stand on parts of the base and are replaced one after the other, in
// the order in which they came.

#include <algorithm>
#include <deque>

#include "tafoni/core/error.h"
#include "tafoni/grammar/derive.h"

namespace tafoni::grammar {
namespace {

enum class RulesStream : std::uint64_t { rules = 0x5275 };

// What nobody means, and what would never end.
constexpr double least_size = 1e-3, greatest_size = 1e4;  // multiples of the layer's size
constexpr int deepest = 8;                                // shapes made of shapes
constexpr int most_idle = 10000;                          // empty shapes in all
constexpr int most_stored = 256;                          // productions of one shape
constexpr std::size_t most_open = 100000;                 // symbols that wait
constexpr int size_draws = 4;                             // sizes drawn for a production before it is dropped

struct Range {
  double lo = 1, hi = 1;
};

struct Rule {
  std::string where, symbol, shape;
  Production how;
  std::vector<Range> size;
  double weight = 1;
  std::vector<std::string> next;
};

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t begin = text.find_first_not_of(" \t\n,");
    if (begin == text.npos) return out;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(" \t\n,"), text.size());
    out.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

double number(std::string_view text, double otherwise) {
  const auto numbers = numbers_in(text);
  return numbers && numbers->size() == 1 ? numbers->front() : otherwise;
}

/// "2", or "1.5..3" for a size drawn between the two.
Range range(std::string_view text, const std::string& where) {
  const std::size_t dots = text.find("..");
  const double lo = number(text.substr(0, dots), 0);
  const double hi = dots == text.npos ? lo : number(text.substr(dots + 2), 0);
  if (!(lo >= least_size && hi >= lo && hi <= greatest_size))
    fail(ErrorKind::usage, "{}: size = \"{}\" must be a number from {:g} to {:g}, or two as in 1..2", where,
         text, least_size, greatest_size);
  return {lo, hi};
}

Rule rule(const Row& row, std::size_t number_of_row, const Settings& settings) {
  Rule out;
  out.where = fmt::format("rule, row {}", number_of_row + 1);
  const auto cell = [&](std::string_view name) -> const std::string& { return row.find(name)->second; };
  for (const ParamInfo& column : rule_columns()) check_cell(column, cell(column.name), out.where);
  out.symbol = cell("symbol");
  out.shape = cell("shape");
  if (out.symbol.empty() || out.shape.empty())
    fail(ErrorKind::usage, "{}: it needs a symbol and a shape", out.where);
  out.how.operation = operation_of(cell("operation"));
  const std::string& label = cell("label");
  out.how.direction = direction_of(label.empty() ? std::string_view(settings.direction) : label);
  for (const std::string_view word : words(cell("size"))) out.size.push_back(range(word, out.where));
  if (out.size.size() != 1 && out.size.size() != 3)
    fail(ErrorKind::usage, "{}: size must be one half width, or three along x, y and z", out.where);
  out.how.alpha = number(cell("morph"), 100 * settings.morph) / 100;
  out.how.sink = number(cell("sink"), settings.overlap);
  out.how.turn = settings.turn;
  out.how.whole = settings.whole;
  out.weight = number(cell("weight"), 1);
  for (const std::string_view word : words(cell("next"))) out.next.emplace_back(word);
  return out;
}

class Rewriting {
 public:
  Rewriting(const Rows& rows, const Settings& settings, Progress& progress)
      : settings_(settings), progress_(progress), random_(settings.seed, RulesStream::rules) {
    for (std::size_t i = 0; i < rows.size(); ++i) rules_.push_back(rule(rows[i], i, settings));
    for (const Rule& r : rules_) {
      for (const std::string& symbol : r.next)
        if (!known(symbol)) fail(ErrorKind::usage, "{}: no rule says what \"{}\" is", r.where, symbol);
      if (known(r.shape)) continue;
      try {
        find_solid(r.shape);
      } catch (const Error& error) {
        fail(error.kind(), "{}: {}, and no rule has it as its symbol", r.where, error.what());
      }
    }
  }

  void run(Assembly& base, const Assembly::Accept& accept) {
    progress_.begin("productions", settings_.classic + settings_.morphic, "productions");
    if (!rules_.empty())
      rewrite(base, rules_.front().symbol, settings_.classic, settings_.morphic, accept, 0);
    progress_.end();
  }

 private:
  bool known(std::string_view symbol) const {
    return std::any_of(rules_.begin(), rules_.end(), [&](const Rule& r) { return r.symbol == symbol; });
  }

  const Rule* draw(std::string_view symbol) {
    double sum = 0;
    for (const Rule& r : rules_) sum += r.symbol == symbol ? r.weight : 0;
    double left = random_.uniform() * sum;
    const Rule* last = nullptr;
    for (const Rule& r : rules_) {
      if (r.symbol != symbol || r.weight == 0) continue;
      last = &r;
      if ((left -= r.weight) < 0) break;
    }
    return last;
  }

  Shape shape(const Rule& r, int depth) {
    const auto draw_size = [&](const Range& range) { return random_.uniform(range.lo, range.hi); };
    Vec3d half;
    if (r.size.size() == 1) {
      half.x = half.y = half.z = draw_size(r.size[0]);
    } else {
      half.x = draw_size(r.size[0]);
      half.y = draw_size(r.size[1]);
      half.z = draw_size(r.size[2]);
    }
    if (!known(r.shape)) {
      const SolidType& type = find_solid(r.shape);
      try {
        return shape_of(type.make(type.fit(half * settings_.size)));
      } catch (const Error& error) {
        fail(error.kind(), "{}: {}", r.where, error.what());
      }
    }
    if (depth >= deepest)
      fail(ErrorKind::usage, "{}: \"{}\" is made of itself without end", r.where, r.shape);
    Assembly stored;
    rewrite(stored, r.shape, std::max<std::int64_t>(1, settings_.per_shape), 0, nullptr, depth + 1);
    return stored.shape();
  }

  void rewrite(Assembly& base, const std::string& axiom, std::int64_t classic, std::int64_t morphic,
               const Assembly::Accept& accept, int depth) {
    struct Standing {
      std::string symbol;
      int part;
    };
    std::deque<Standing> open = {{axiom, -1}};
    bool first = true;
    while (!open.empty() && classic + morphic > 0) {
      progress_.check();
      const Standing at = open.front();
      open.pop_front();
      const Rule* r = draw(at.symbol);
      if (!r) continue;
      std::int64_t& left = r->how.operation == Operation::morph ? morphic : classic;
      Production how = r->how;
      if (first) how.direction = {};
      how.part = at.part;
      // The empty shape is no production: its symbols go on where its own stood.
      const bool nothing = r->shape == "empty";
      if (!nothing) {
        if (left == 0) continue;
        if (depth == 0)
          stored_ = 0;
        else if (++stored_ > most_stored)
          fail(ErrorKind::usage, "{}: one shape is made of more than {} productions; nest fewer symbols",
               r->where, most_stored);
        if (!place(base, *r, how, accept, depth)) continue;
        --left;
        first = false;
        if (depth == 0) progress_.advance();
        if (how.whole && (how.operation == Operation::morph || how.operation == Operation::intersection))
          for (Standing& other : open) other.part = 0;
      } else if (++idle_ > most_idle) {
        fail(ErrorKind::usage, "{}: empty shapes follow one another without end", r->where);
      }
      const bool grew = !nothing && how.operation == Operation::sum;
      const int last = static_cast<int>(base.parts().size()) - 1,
                part = grew ? last : std::min(at.part, last);
      for (const std::string& symbol : r->next) open.push_back({symbol, part});
      if (open.size() > most_open)
        fail(ErrorKind::usage, "{}: more than {} symbols wait for a production; let fewer follow", r->where,
             most_open);
    }
  }

  bool place(Assembly& base, const Rule& r, const Production& how, const Assembly::Accept& accept,
             int depth) {
    for (int i = 0; i < size_draws; ++i)
      if (base.produce(shape(r, depth), how, random_, accept)) return true;
    return false;
  }

  const Settings& settings_;
  Progress& progress_;
  Random random_;
  std::vector<Rule> rules_;
  int idle_ = 0, stored_ = 0;  ///< empty shapes so far; productions of the shape that is being made
};

}  // namespace

std::vector<ParamInfo> rule_columns() {
  return {
      column("symbol", "", "Symbol that the rule replaces"),
      column("shape", "", "Shape that it adds: a solid, empty, or a symbol whose own rules make it"),
      choice_column("operation", "sum", {"sum", "difference", "intersection", "morph"},
                    "How the shape joins the base"),
      choice_column("label", "", direction_names(),
                    "Side of the base where the shape joins; empty for the layer's direction"),
      column("size", "1",
             "Half width, or three along x, y and z, as multiples of the layer's size; a..b for any between"),
      numbers_column("morph", "", "%", 1, 0, 100, "Share of the shape in a morph; empty for the layer's"),
      numbers_column("sink", "", "", 1, 0, 1,
                     "Share of its extent that the shape is pushed in; empty for the layer's overlap"),
      numbers_column("weight", "1", "", 1, 0, 1e9, "How likely the rule is among those of its symbol"),
      column("next", "", "Symbols that go on from the shape; empty for none")};
}

void derive_by_rules(Assembly& base, const Rows& rules, const Settings& settings,
                     const Assembly::Accept& accept, Progress& progress) {
  Rewriting(rules, settings, progress).run(base, accept);
}

}  // namespace tafoni::grammar
