#pragma once
// A tree of operations on placed solids [Zawadzki §2.1, §2.3]: what productions make.

#include <memory>
#include <string_view>
#include <vector>

#include "tafoni/field/tree.h"
#include "tafoni/grammar/pose.h"

namespace tafoni::grammar {

enum class Operation { sum, difference, intersection, morph };
Operation operation_of(std::string_view name);  ///< Throws Error{usage} naming the four

struct Form;
using FormPtr = std::shared_ptr<const Form>;

/// Either a solid or an operation on two or more forms; immutable, so that forms share their parts.
struct Form {
  Pose pose;       ///< of the whole
  SolidPtr solid;  ///< null for an operation
  Operation operation = Operation::sum;
  std::vector<FormPtr> of;
  double alpha = 0;  ///< of a morph
};

FormPtr placed(FormPtr form, const Pose& pose);
FormPtr combined(Operation operation, FormPtr a, FormPtr b, double alpha = 0);
/// The sum of any number; null for none.
FormPtr sum(std::vector<FormPtr> forms);

/// max, min(f, -g), min and f (1 - alpha) + g alpha over distances (equations 2 to 5), as a construction
/// tree whose leaves hold their own poses. Null becomes a constant far below 0.
field::NodePtr tree(const FormPtr& form);

}  // namespace tafoni::grammar
