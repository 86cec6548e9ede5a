#pragma once
// The compiled field: a tree flattened to a postfix program over its leaves.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "tafoni/field/impl/node.h"

namespace tafoni::field::impl {

struct Instruction {
  enum class Kind : std::uint8_t {
    height,    ///< push the height leaf `index`
    domain,    ///< push the domain leaf `index`
    constant,  ///< push `value`
    nested,    ///< push the nested leaf `index`
    add,       ///< add the cloud `index` to the top, primitive by primitive
    apply,     ///< combine the two topmost with the operator, whose parameter is `value`
  };
  Kind kind;
  std::uint32_t index = 0;
  float value = 0;
  const Combination* op = nullptr;
  std::uint32_t first_begin = 0, second_begin = 0;  ///< of apply: where its operands' code starts
};

struct Program {
  NodePtr root;  ///< keeps the leaves alive
  std::vector<Instruction> code;
  std::vector<const HeightLeaf*> heights;
  std::vector<const DomainLeaf*> domains;
  std::vector<const Cloud*> clouds;
  std::vector<std::shared_ptr<const Nested>> nested;
  std::size_t depth = 0;  ///< greatest number of values on the stack
  float reach = 0;        ///< mean radius of the primitives' supports, metres; 0 without primitives
};

/// Compiles trees, each node that is asked elsewhere once.
class Compiler {
 public:
  std::shared_ptr<const Program> program(const NodePtr& root);

 private:
  std::shared_ptr<const Nested> nested(const NestedNode& node);

  std::unordered_map<const Node*, std::shared_ptr<const Program>> programs_;
  std::unordered_map<const NestedNode*, std::shared_ptr<const Nested>> nested_;
};

/// Holds the surface. Where functions take part it is the zone in which the other leaves may be near 0.
Box3d bounds(const Program& program);

/// Ranges of one evaluation, and which code the ranges made needless.
struct RangeWork {
  std::vector<Interval> stack;
  std::vector<std::uint8_t> dead;  ///< one an instruction
};

/// The range of the whole program, given the range of each leaf: `leaf(instruction)` for height, domain,
/// nested and add. Fills work.dead: an instruction is dead when an operator's result is bit for bit its other
/// operand.
template <class LeafRange>
Interval range_of(const Program& program, RangeWork& work, const LeafRange& leaf) {
  auto& stack = work.stack;
  stack.clear();
  work.dead.assign(program.code.size(), 0);
  for (std::size_t i = 0; i < program.code.size(); ++i) {
    const Instruction& in = program.code[i];
    switch (in.kind) {
      case Instruction::Kind::height:
      case Instruction::Kind::domain:
      case Instruction::Kind::nested:
        stack.push_back(leaf(in));
        break;
      case Instruction::Kind::constant:
        stack.push_back({in.value, in.value});
        break;
      case Instruction::Kind::add: {
        const Interval sum = leaf(in);
        if (sum.lo == 0 && sum.hi == 0) {
          work.dead[i] = 1;
          break;
        }
        Interval& top = stack.back();
        top = top + sum;
        // Float sums of a few thousand terms round by far less than this.
        const float slack =
            1e-5f * (std::fabs(sum.lo) + std::fabs(sum.hi) + std::fabs(top.lo) + std::fabs(top.hi));
        top.lo -= slack;
        top.hi += slack;
        break;
      }
      case Instruction::Kind::apply: {
        const Interval b = stack.back();
        stack.pop_back();
        Interval& a = stack.back();
        const Needs needs = in.op->needs(a, b, in.value);
        if (needs == Needs::first)
          std::fill(work.dead.begin() + in.second_begin, work.dead.begin() + i + 1, std::uint8_t{1});
        if (needs == Needs::second) {
          std::fill(work.dead.begin() + in.first_begin, work.dead.begin() + in.second_begin, std::uint8_t{1});
          work.dead[i] = 1;
        }
        a = needs == Needs::first ? a : needs == Needs::second ? b : in.op->interval(a, b, in.value);
        break;
      }
    }
  }
  return stack.back();
}

/// Walks the live code: calls push(slot, instruction), add(slot, instruction) and apply(slot, instruction),
/// where apply combines slot and slot + 1 into slot.
template <class Push, class Add, class Apply>
void walk(const Program& program, const std::uint8_t* dead, const Push& push, const Add& add,
          const Apply& apply) {
  int top = -1;
  for (std::size_t i = 0; i < program.code.size(); ++i) {
    if (dead && dead[i]) continue;
    const Instruction& in = program.code[i];
    if (in.kind == Instruction::Kind::add)
      add(top, in);
    else if (in.kind == Instruction::Kind::apply)
      apply(--top, in);
    else
      push(++top, in);
  }
}

/// The range of one height leaf where heights lie in [lo, hi], the first-order scale in [scale_lo, 1] and z
/// in [z0, z1], all as the kernels computed them.
Interval height_range(const HeightLeaf& leaf, float lo, float hi, float scale_lo, float scale_hi, float z0,
                      float z1);
Interval domain_range(const DomainLeaf& leaf, float lo, float hi, float z0, float z1);

}  // namespace tafoni::field::impl
