// Recursive descent over the text makes a postfix program; running it needs a short stack and no memory.

#include "tafoni/landforms/hoodoos/expression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include "tafoni/core/error.h"
#include "tafoni/core/params.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::landforms::impl {
namespace {

/// Of values waiting for their operator, and of brackets within brackets.
constexpr std::size_t deepest = 64;

enum Op : std::uint8_t {
  number,
  variable,
  add,
  subtract,
  multiply,
  divide,
  modulo,
  power,
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  differs,
  both,
  either,
  negate,
  inverse,
  call  ///< call + i: functions[i]
};

using Arguments = const double*;

struct Function {
  std::string_view name;
  std::size_t arity;
  double (*run)(Arguments, const ExpressionInput&);
};

double draw(const ExpressionInput& in) {
  return in.random->uniform();
}

const Function functions[] = {
    {"min", 2, [](Arguments a, const ExpressionInput&) { return std::min(a[0], a[1]); }},
    {"max", 2, [](Arguments a, const ExpressionInput&) { return std::max(a[0], a[1]); }},
    {"clamp", 3, [](Arguments a, const ExpressionInput&) { return std::max(a[1], std::min(a[2], a[0])); }},
    {"mix", 3, [](Arguments a, const ExpressionInput&) { return a[0] + (a[1] - a[0]) * a[2]; }},
    {"step", 3, [](Arguments a, const ExpressionInput&) { return smoothstep(a[0], a[1], a[2]); }},
    {"if", 3, [](Arguments a, const ExpressionInput&) { return a[0] != 0 ? a[1] : a[2]; }},
    {"abs", 1, [](Arguments a, const ExpressionInput&) { return std::abs(a[0]); }},
    {"floor", 1, [](Arguments a, const ExpressionInput&) { return std::floor(a[0]); }},
    {"ceil", 1, [](Arguments a, const ExpressionInput&) { return std::ceil(a[0]); }},
    {"sqrt", 1, [](Arguments a, const ExpressionInput&) { return std::sqrt(a[0]); }},
    {"exp", 1, [](Arguments a, const ExpressionInput&) { return std::exp(a[0]); }},
    {"log", 1, [](Arguments a, const ExpressionInput&) { return std::log(a[0]); }},
    {"sin", 1, [](Arguments a, const ExpressionInput&) { return std::sin(degree * a[0]); }},
    {"cos", 1, [](Arguments a, const ExpressionInput&) { return std::cos(degree * a[0]); }},
    {"random", 0, [](Arguments, const ExpressionInput& in) { return draw(in); }},
    {"random", 2, [](Arguments a, const ExpressionInput& in) { return a[0] + (a[1] - a[0]) * draw(in); }},
    {"", 1, [](Arguments a, const ExpressionInput& in) { return (*in.probe)(a[0]); }},
};
constexpr std::size_t probe_function = std::size(functions) - 1;

double binary(std::uint8_t op, double a, double b) {
  switch (op) {
    case add:
      return a + b;
    case subtract:
      return a - b;
    case multiply:
      return a * b;
    case divide:
      return a / b;
    case modulo:
      return a - b * std::floor(a / b);
    case power:
      return std::pow(a, b);
    case less:
      return a < b;
    case less_equal:
      return a <= b;
    case greater:
      return a > b;
    case greater_equal:
      return a >= b;
    case equal:
      return a == b;
    case differs:
      return a != b;
    case both:
      return a != 0 && b != 0;
    default:
      return a != 0 || b != 0;
  }
}

struct Infix {
  std::string_view token;
  Op op;
};
/// Loosest first; within a level, a token before those that it begins with.
const std::vector<Infix> precedences[] = {
    {{"||", either}},
    {{"&&", both}},
    {{"<=", less_equal}, {">=", greater_equal}, {"==", equal}, {"!=", differs}, {"<", less}, {">", greater}},
    {{"+", add}, {"-", subtract}},
    {{"*", multiply}, {"/", divide}, {"%", modulo}},
};

}  // namespace

bool Scanner::take(std::string_view token) {
  if (text_.substr(at_, token.size()) != token) return false;
  at_ += token.size();
  skip();
  return true;
}

void Scanner::expect(std::string_view token) {
  if (take(token)) return;
  error(at_end() ? fmt::format("\"{}\" is missing at the end", token)
                 : fmt::format("expected \"{}\", found \"{}\"", token, peek()));
}

std::string_view Scanner::name() {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  if (!letter(peek())) return {};
  const std::size_t from = at_;
  while (!at_end() && (letter(text_[at_]) || (text_[at_] >= '0' && text_[at_] <= '9'))) ++at_;
  const std::string_view found = text_.substr(from, at_ - from);
  skip();
  return found;
}

bool Scanner::number(double& value) {
  const char c = peek();
  if (c != '.' && !(c >= '0' && c <= '9')) return false;
  const auto [end, code] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
  if (code != std::errc()) error("this is not a number");
  at_ = end - text_.data();
  skip();
  return true;
}

void Scanner::skip() {
  while (!at_end() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
    ++at_;
}

void Scanner::error(std::size_t column, std::string_view sentence) const {
  fail(ErrorKind::usage, "{}, column {}: {}", where_, column, sentence);
}

/// Recursive descent; brackets are counted, so that no text can exhaust the program's own stack.
class ExpressionCompiler {
 public:
  ExpressionCompiler(Scanner& text, const ExpressionNames& names) : text_(text), names_(names) {}

  Expression run() {
    Expression out;
    out.steps_.clear();
    steps_ = &out.steps_;
    infix(0);
    return out;
  }

 private:
  void infix(std::size_t level) {
    if (level == std::size(precedences)) return prefix();
    infix(level + 1);
    for (;;) {
      const auto found = std::find_if(precedences[level].begin(), precedences[level].end(),
                                      [&](const Infix& x) { return text_.take(x.token); });
      if (found == precedences[level].end()) return;
      infix(level + 1);
      emit(found->op, 0, 2);
    }
  }

  void prefix() {
    const Nested nested(*this);
    if (text_.take("-")) {
      prefix();
      return emit(negate, 0, 1);
    }
    if (text_.take("!")) {
      prefix();
      return emit(inverse, 0, 1);
    }
    operand();
    if (!text_.take("^")) return;
    prefix();
    emit(power, 0, 2);
  }

  void operand() {
    double value = 0;
    if (text_.number(value)) return emit(number, value, 0);
    if (text_.take("(")) {
      infix(0);
      return text_.expect(")");
    }
    const std::size_t column = text_.column();
    const std::string_view name = text_.name();
    if (name.empty())
      text_.error(text_.at_end() ? "a value is missing at the end"
                                 : fmt::format("expected a value, found \"{}\"", text_.peek()));
    if (text_.take("(")) return function(name, column);
    const auto known = std::find(names_.variables.begin(), names_.variables.end(), name);
    if (known == names_.variables.end()) unknown("name", name, column, variables());
    emit(variable, static_cast<double>(known - names_.variables.begin()), 0);
  }

  void function(std::string_view name, std::size_t column) {
    std::size_t given = 0;
    if (!text_.take(")")) {
      do {
        infix(0);
        ++given;
      } while (text_.take(","));
      text_.expect(")");
    }
    const bool probe = !name.empty() && name == names_.probe;
    std::string arities;
    for (std::size_t i = 0; i < std::size(functions); ++i) {
      if (probe ? i != probe_function : i == probe_function || functions[i].name != name) continue;
      if (functions[i].arity == given) return emit(static_cast<std::uint8_t>(call + i), 0, given);
      arities += fmt::format("{}{}", arities.empty() ? "" : " or ", functions[i].arity);
    }
    if (arities.empty()) unknown("function", name, column, expression_functions());
    text_.error(column, fmt::format("{} takes {} values, not {}", name, arities, given));
  }

  std::vector<std::string> variables() const { return {names_.variables.begin(), names_.variables.end()}; }

  [[noreturn]] void unknown(std::string_view what, std::string_view name, std::size_t column,
                            const std::vector<std::string>& known) const {
    const std::string near = nearest(name, known);
    std::string all;
    for (const std::string& k : known) all += (all.empty() ? "" : ", ") + k;
    text_.error(column, near.empty()
                            ? fmt::format("there is no {} \"{}\"; known are {}", what, name, all)
                            : fmt::format("there is no {} \"{}\"; did you mean \"{}\"?", what, name, near));
  }

  void emit(std::uint8_t op, double value, std::size_t takes) {
    waiting_ = waiting_ - takes + 1;
    if (waiting_ > deepest)
      text_.error("more than 64 values wait here for their operator; split the expression");
    steps_->push_back({op, value});
  }

  struct Nested {
    explicit Nested(ExpressionCompiler& compiler) : depth(compiler.depth_) {
      if (++depth > deepest) compiler.text_.error("brackets and signs are nested more than 64 deep");
    }
    ~Nested() { --depth; }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;
    std::size_t& depth;
  };

  Scanner& text_;
  const ExpressionNames& names_;
  std::vector<Expression::Step>* steps_ = nullptr;
  std::size_t waiting_ = 0, depth_ = 0;
};

Expression::Expression(double value) : steps_{{number, value}} {}

Expression Expression::compile(Scanner& text, const ExpressionNames& names) {
  return ExpressionCompiler(text, names).run();
}

double Expression::operator()(const ExpressionInput& input) const {
  std::array<double, deepest> stack;
  double* top = stack.data();  // just beyond the last value
  for (const Step& step : steps_) {
    if (step.op == number) {
      *top++ = step.value;
    } else if (step.op == variable) {
      *top++ = input.variables[static_cast<std::size_t>(step.value)];
    } else if (step.op == negate) {
      top[-1] = -top[-1];
    } else if (step.op == inverse) {
      top[-1] = top[-1] == 0;
    } else if (step.op < negate) {
      --top;
      top[-1] = binary(step.op, top[-1], top[0]);
    } else {
      const Function& f = functions[step.op - call];
      top -= f.arity;
      *top = f.run(top, input);
      ++top;
    }
  }
  return stack[0];
}

std::vector<std::string> expression_functions() {
  std::vector<std::string> names;
  for (const Function& f : functions)
    if (!f.name.empty() && (names.empty() || names.back() != f.name)) names.emplace_back(f.name);
  return names;
}

}  // namespace tafoni::landforms::impl
