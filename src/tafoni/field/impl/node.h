#pragma once
// The node behind NodePtr.

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "tafoni/field/impl/cloud.h"
#include "tafoni/field/impl/leaves.h"
#include "tafoni/field/impl/nested.h"
#include "tafoni/field/operator.h"
#include "tafoni/field/tree.h"

namespace tafoni::field {

class Node {
 public:
  struct Operation {
    const OperatorType* type;
    std::vector<NodePtr> children;
    float parameter = 0;  ///< the operator's own, where it has one
  };
  using NestedPtr = std::unique_ptr<const impl::NestedNode>;
  using Content = std::variant<impl::HeightLeaf, impl::DomainLeaf, float, impl::Cloud, Operation, NestedPtr>;

  explicit Node(Content c);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  /// Frees a deep chain without recursion.
  ~Node();

  const Operation* operation() const { return std::get_if<Operation>(&content); }
  const impl::Cloud* cloud() const { return std::get_if<impl::Cloud>(&content); }
  const impl::NestedNode* nested() const {
    const auto* own = std::get_if<NestedPtr>(&content);
    return own ? own->get() : nullptr;
  }

  Content content;
  int depth = 0;  ///< operators that move space, one in another
};

}  // namespace tafoni::field
