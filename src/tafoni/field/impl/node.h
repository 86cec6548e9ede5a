#pragma once
// The node behind NodePtr.

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "tafoni/field/impl/cloud.h"
#include "tafoni/field/impl/leaves.h"
#include "tafoni/field/operator.h"
#include "tafoni/field/tree.h"

namespace tafoni::field {

class Node {
 public:
  struct Operation {
    const OperatorType* type;
    std::vector<NodePtr> children;
  };
  using Content = std::variant<impl::HeightLeaf, impl::DomainLeaf, float, impl::Cloud, Operation>;

  explicit Node(Content c) : content(std::move(c)) {}
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  /// Frees a deep chain without recursion.
  ~Node();

  const Operation* operation() const { return std::get_if<Operation>(&content); }
  const impl::Cloud* cloud() const { return std::get_if<impl::Cloud>(&content); }

  Content content;
};

}  // namespace tafoni::field
