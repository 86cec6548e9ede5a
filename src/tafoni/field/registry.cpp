#include "tafoni/core/error.h"
#include "tafoni/field/operator.h"
#include "tafoni/field/primitive.h"

namespace tafoni::field {
namespace {

template <class Type>
const Type& find(std::span<const Type* const> all, std::string_view name, std::string_view what) {
  std::vector<std::string> names;
  for (const Type* type : all) {
    if (type->name == name) return *type;
    names.push_back(type->name);
  }
  const std::string near = nearest(name, names);
  if (near.empty()) fail(ErrorKind::usage, "unknown {} \"{}\"", what, name);
  fail(ErrorKind::usage, "unknown {} \"{}\"; did you mean \"{}\"?", what, name, near);
}

}  // namespace

const PrimitiveType& find_primitive(std::string_view name) {
  return find(all_primitives(), name, "primitive");
}

const OperatorType& find_operator(std::string_view name) {
  return find(all_operators(), name, "operator");
}

}  // namespace tafoni::field
