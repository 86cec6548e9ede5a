#include "tafoni/core/error.h"
#include "tafoni/field/operator.h"
#include "tafoni/field/primitive.h"

namespace tafoni::field {

const PrimitiveType& find_primitive(std::string_view name) {
  return find(all_primitives(), name, "primitive");
}

const OperatorType& find_operator(std::string_view name) {
  return find(all_operators(), name, "operator");
}

}  // namespace tafoni::field
