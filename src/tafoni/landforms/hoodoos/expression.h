#pragma once
// Arithmetic that users write in tables: compiled once to a short postfix program, run many times.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/random.h"

namespace tafoni::landforms::impl {

/// Text that is read from left to right. Errors name where the text comes from and the column.
class Scanner {
 public:
  Scanner(std::string_view text, std::string where) : text_(text), where_(std::move(where)) { skip(); }

  bool at_end() const { return at_ == text_.size(); }
  std::size_t column() const { return at_ + 1; }
  char peek() const { return at_end() ? '\0' : text_[at_]; }
  /// Takes `token` when it comes next.
  bool take(std::string_view token);
  /// Takes `token` or throws "... expected \"token\"".
  void expect(std::string_view token);
  /// A name [A-Za-z_][A-Za-z0-9_]*, empty when none comes next.
  std::string_view name();
  /// Whether a number comes next, and it.
  bool number(double& value);
  /// Throws Error{usage}: "WHERE, column N: SENTENCE".
  [[noreturn]] void error(std::size_t column, std::string_view sentence) const;
  [[noreturn]] void error(std::string_view sentence) const { error(column(), sentence); }

 private:
  void skip();

  std::string_view text_;
  std::string where_;
  std::size_t at_ = 0;
};

/// What an expression may ask when it is run.
struct ExpressionInput {
  std::span<const double> variables;           ///< in the order of the names given to compile()
  Random* random = nullptr;                    ///< what random() draws from
  std::function<double(double)> const* probe;  ///< the function that has the name `probe` of compile()
};

/// Names that an expression may use besides the functions that are always there.
struct ExpressionNames {
  std::span<const std::string_view> variables;
  /// One that is also a function of one number: "rho" and "rho(2)". Empty: none.
  std::string_view probe;
};

/// + - * / % ^, comparisons, && || ! (0 is false), and functions; angles are in degrees. Every part of an
/// expression is run, so that the count of random numbers drawn does not depend on values.
class Expression {
 public:
  /// A constant.
  explicit Expression(double value = 0);
  /// Reads as far as an expression goes. Throws Error{usage} naming the column.
  static Expression compile(Scanner& text, const ExpressionNames& names);
  double operator()(const ExpressionInput& input) const;
  /// How many operations a run takes.
  std::size_t steps() const { return steps_.size(); }

 private:
  friend class ExpressionCompiler;
  struct Step {
    std::uint8_t op;
    double value;  ///< of a number; the index of a variable
  };
  std::vector<Step> steps_;
};

/// What expressions can do, for a manual and for error texts: operators' and functions' names.
std::vector<std::string> expression_functions();

}  // namespace tafoni::landforms::impl
