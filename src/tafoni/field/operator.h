#pragma once
// What the program knows of an operator. One file each in operators/.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/registry.h"
#include "tafoni/math/vec.h"

namespace tafoni::field {

namespace impl {
struct OperatorKernels;
}

/// What an operator needs of its operands where only their ranges are known.
enum class Needs { both, first, second };

/// An operator either combines two values (all three functions below; at most one parameter, which they get)
/// or asks its operand elsewhere or takes functions (none of them; made by the function of tree.h of its
/// name).
struct OperatorType {
  Declaration about = {};
  Interval (*interval)(Interval a, Interval b, float parameter) = nullptr;
  /// `first` or `second` when the result is bit for bit that operand over the whole range.
  Needs (*needs)(Interval a, Interval b, float parameter) = nullptr;
  const impl::OperatorKernels& (*kernels)() = nullptr;

  bool combines() const { return kernels != nullptr; }
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
