#include "tafoni/landforms/hoodoos/expression.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"

namespace tafoni::landforms::impl {
namespace {

constexpr std::string_view known[] = {"s", "rho", "height"};
const ExpressionNames names{known, "rho"};
constexpr double s = 3, rho = 0.25, height = 12;

Expression compiled(std::string_view text) {
  Scanner scanner(text, "rule 1 (A), weight");
  Expression expression = Expression::compile(scanner, names);
  EXPECT_TRUE(scanner.at_end()) << text;
  return expression;
}

double value(std::string_view text) {
  const double values[] = {s, rho, height};
  Random random(1);
  const std::function<double(double)> probe = [](double dz) { return rho + dz; };
  return compiled(text)({values, &random, &probe});
}

std::string error_of(std::string_view text) {
  try {
    compiled(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "no error";
}

TEST(Expression, IsArithmetic) {
  EXPECT_DOUBLE_EQ(value("1 + 2*3 - 4/8"), 1 + 2 * 3 - 4 / 8.0);
  EXPECT_DOUBLE_EQ(value("(1 + 2)*3"), 9);
  EXPECT_DOUBLE_EQ(value("10 - 4 - 3"), 3);
  EXPECT_DOUBLE_EQ(value("-2^2"), -4);
  EXPECT_DOUBLE_EQ(value("2^3^2"), 512);
  EXPECT_DOUBLE_EQ(value("2^-1"), 0.5);
  EXPECT_DOUBLE_EQ(value("--3"), 3);
  EXPECT_DOUBLE_EQ(value("7 % 3 + -1 % 3"), 1 + 2);
  EXPECT_DOUBLE_EQ(value("1.5e2 + .5"), 150.5);
  EXPECT_DOUBLE_EQ(value(" s*(0.4+rho) "), s * (0.4 + rho));
}

TEST(Expression, ComparesAndDecides) {
  EXPECT_EQ(value("1 < 2"), 1);
  EXPECT_EQ(value("1 >= 2"), 0);
  EXPECT_EQ(value("s == 3 && rho != 1"), 1);
  EXPECT_EQ(value("0 || 2"), 1);
  EXPECT_EQ(value("!(height > 10) || s <= 3"), 1);
  EXPECT_EQ(value("1 + 1 < 1 + 2"), 1);
  EXPECT_EQ(value("if(rho < 0.5, 10, 20)"), 10);
}

TEST(Expression, HasFunctions) {
  EXPECT_DOUBLE_EQ(value("min(s, 2) + max(s, 5) + clamp(9, 0, 4)"), 2 + 5 + 4);
  EXPECT_DOUBLE_EQ(value("mix(10, 20, rho)"), 12.5);
  EXPECT_DOUBLE_EQ(value("step(0, 1, 0.5) + step(0, 1, -1) + step(0, 1, 2)"), 1.5);
  EXPECT_DOUBLE_EQ(value("abs(-2) + floor(1.7) + ceil(1.2)"), 5);
  EXPECT_NEAR(value("sin(30) + cos(60) + sqrt(16) + exp(0) + log(1)"), 6, 1e-12);
  EXPECT_DOUBLE_EQ(value("rho(0.5) + rho"), 2 * rho + 0.5);
}

TEST(Expression, DrawsUniformly) {
  const double values[] = {s, rho, height};
  Random random(3);
  const Expression draw = compiled("random(2, 6)"), unit = compiled("random()");
  double sum = 0, unit_sum = 0;
  for (int i = 0; i < 4000; ++i) {
    const double v = draw({values, &random, nullptr});
    ASSERT_GE(v, 2);
    ASSERT_LT(v, 6);
    sum += v;
    unit_sum += unit({values, &random, nullptr});
  }
  EXPECT_NEAR(sum / 4000, 4, 0.1);
  EXPECT_NEAR(unit_sum / 4000, 0.5, 0.025);
}

TEST(Expression, ErrorsNameTheColumnAndTheNearestName) {
  EXPECT_EQ(error_of("s + rhoo"),
            "rule 1 (A), weight, column 5: there is no name \"rhoo\"; did you mean \"rho\"?");
  EXPECT_EQ(error_of("1 + "), "rule 1 (A), weight, column 5: a value is missing at the end");
  EXPECT_EQ(error_of("(1 + 2"), "rule 1 (A), weight, column 7: \")\" is missing at the end");
  EXPECT_EQ(error_of("2 * * 3"), "rule 1 (A), weight, column 5: expected a value, found \"*\"");
  EXPECT_EQ(error_of("min(1)"), "rule 1 (A), weight, column 1: min takes 2 values, not 1");
  EXPECT_EQ(error_of("random(1)"), "rule 1 (A), weight, column 1: random takes 0 or 2 values, not 1");
  EXPECT_EQ(error_of("flor(1)"),
            "rule 1 (A), weight, column 1: there is no function \"flor\"; did you mean \"floor\"?");
  EXPECT_THAT(error_of("qqqqqqqqq"), testing::HasSubstr("known are s, rho, height"));
}

TEST(Expression, NestsToALimitOnly) {
  const std::string fine = std::string(40, '(') + "1" + std::string(40, ')');
  EXPECT_EQ(value(fine), 1);
  EXPECT_THAT(error_of(std::string(100000, '(')), testing::HasSubstr("nested more than 64 deep"));
  EXPECT_THAT(error_of(std::string(100000, '-') + "1"), testing::HasSubstr("nested more than 64 deep"));
  std::string wide = "1";
  for (int i = 0; i < 5000; ++i) wide += "+1";
  EXPECT_EQ(value(wide), 5001);
}

}  // namespace
}  // namespace tafoni::landforms::impl
