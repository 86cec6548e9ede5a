#pragma once
// How hoodoos grow: an open parameterized grammar of solids [Paris19 §6.3]. Rules are rows of text; symbols
// see the rock and the ground where they stand while they grow [Mech96].

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/field/primitive.h"
#include "tafoni/landforms/hoodoos/expression.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms::impl {

/// What a growing symbol sees. Positions are local, metres.
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  virtual double resistance(Vec3d p) const = 0;  ///< rho in [0, 1]
  virtual double ground(Vec3d p) const = 0;      ///< elevation below or above p
  virtual double bed(Vec3d p) const = 0;         ///< metres from p up to the next bedding plane, > 0
  virtual bool allowed(Vec3d p) const = 0;       ///< symbols elsewhere vanish
};

/// Where growth begins.
struct Axiom {
  Vec3d position;
  double turn = 0;                 ///< radians
  double height = 10, radius = 2;  ///< metres; what rules may read as `height` and `radius`; s is the radius
  double skin = 0;                 ///< metres of rock beyond a solid's own surface; `skin` in rules
  double datum = 0;                ///< world elevation of local zero
  std::uint64_t seed = 0;
};

struct Terminal {
  static constexpr std::size_t most = 12;
  const field::PrimitiveType* kind = nullptr;
  Vec3d position;
  double energy = 1;
  std::array<float, most> shape{};  ///< as the kind's record has it
};

/// The columns of a table of rules: symbol, weight, make.
std::vector<ParamInfo> rule_columns();

class GrowthRules {
 public:
  /// Throws Error{usage} naming the rule, the column of the table and that of its text.
  GrowthRules(const Rows& rules, std::string_view where);
  bool has(std::string_view symbol) const { return find(symbol) >= 0; }
  std::vector<std::string> symbols() const;
  /// Everything that grows from `symbol`, in an order that depends on the seed alone. Throws Error{usage}
  /// when a size is not finite or growth does not end.
  std::vector<Terminal> grow(std::string_view symbol, const Axiom& axiom,
                             const Surroundings& surroundings) const;

 private:
  friend class Derivation;
  /// One of what a rule makes: a primitive when `kind` is given, else a symbol.
  struct Term {
    const field::PrimitiveType* kind = nullptr;
    int symbol = -1;
    std::size_t column = 0;
    Expression repeat{1}, x, y, z, turn, energy{1};
    std::vector<Expression> sizes;  ///< of a primitive, its record; of a symbol, s, a, b, c
  };
  struct Rule {
    std::string where;
    Expression weight;
    std::vector<Term> terms;
  };
  struct Symbol {
    std::string name;
    std::vector<Rule> rules;
  };

  int find(std::string_view symbol) const;
  void add_rule(std::string_view symbol, std::string_view weight, std::string_view make,
                std::string_view where);
  Term term(Scanner& text) const;
  /// Reads "NAME = EXPRESSION" into what a term has of that name.
  void read_argument(Scanner& text, Term& term, std::string_view of) const;
  Expression* argument(Term& term, std::string_view name) const;

  std::string where_;
  std::vector<Symbol> symbols_;
};

}  // namespace tafoni::landforms::impl
