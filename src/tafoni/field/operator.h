#pragma once
// What the program knows of an operator. One file each in operators/combining/ and operators/nested/.

#include <optional>
#include <span>
#include <string_view>

#include "tafoni/core/registry.h"
#include "tafoni/math/vec.h"

namespace tafoni::field {

namespace impl {
struct OperatorKernels;
}

/// What a combination needs of its operands where only their ranges are known.
enum class Needs { both, first, second };

/// How the values that two trees have at one place become one. `parameter` is the operator's own, if it has
/// one; it may not have more.
struct Combination {
  /// Encloses every result.
  Interval (*interval)(Interval a, Interval b, float parameter);
  /// `first` or `second` when the result is bit for bit that operand over the whole range.
  Needs (*needs)(Interval a, Interval b, float parameter);
  /// For the instruction set this machine has.
  const impl::OperatorKernels& (*kernels)();
};

/// A file of operators/combining/ gives its combination; one of operators/nested/ gives none, because it asks
/// its operand elsewhere or takes functions. Each has a function in tree.h.
struct OperatorType {
  Declaration about = {};
  std::optional<Combination> combination = {};
};

std::span<const OperatorType* const> all_operators();
/// Throws Error{usage} naming the nearest known operator.
const OperatorType& find_operator(std::string_view name);

namespace impl {

struct Block;
struct PointValues;

/// In place on `a`.
struct OperatorKernels {
  void (*block)(const Block& a, const Block& b, float parameter);
  void (*points)(float* a, const float* b, float parameter);
  void (*gradients)(PointValues& a, const PointValues& b, float parameter);
};

}  // namespace impl
}  // namespace tafoni::field
