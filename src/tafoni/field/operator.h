#pragma once
// What the program knows of an operator: a name and how it combines two values. One file each in operators/.

#include <span>
#include <string>
#include <string_view>

#include "tafoni/math/vec.h"

namespace tafoni::field {

namespace impl {
struct OperatorKernels;
}

/// What an operator needs of its operands where only their ranges are known.
enum class Needs { both, first, second };

struct OperatorType {
  std::string name, doc, source;
  Interval (*interval)(Interval a, Interval b) = nullptr;
  /// `first` or `second` when the result is bit for bit that operand over the whole range.
  Needs (*needs)(Interval a, Interval b) = nullptr;
  const impl::OperatorKernels& (*kernels)() = nullptr;
};

std::span<const OperatorType* const> all_operators();
/// Throws Error{usage} naming the nearest known operator.
const OperatorType& find_operator(std::string_view name);

namespace impl {

struct Block;
struct PointValues;

/// In place on `a`.
struct OperatorKernels {
  void (*block)(const Block& a, const Block& b);
  void (*points)(float* a, const float* b);
  void (*gradients)(PointValues& a, const PointValues& b);
};

}  // namespace impl
}  // namespace tafoni::field
