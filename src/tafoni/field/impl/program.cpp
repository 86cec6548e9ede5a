// Compiles a tree: a postfix program over its leaves, made without recursion, for trees may be deep chains.

#include "tafoni/field/impl/program.h"

#include <algorithm>
#include <unordered_map>

namespace tafoni::field::impl {
namespace {

template <class T>
std::uint32_t leaf_index(std::vector<const T*>& leaves, std::unordered_map<const void*, std::uint32_t>& known,
                         const T* leaf) {
  const auto [it, added] = known.try_emplace(leaf, static_cast<std::uint32_t>(leaves.size()));
  if (added) leaves.push_back(leaf);
  return it->second;
}

/// Sigma over [lo, hi]. Its polynomial is monotone, its float evaluation to a few parts in 10^7; beyond the
/// influence it is exactly +-T.
Interval sigma_range(const Sigma& sigma, float lo, float hi) {
  const float t = sigma.amplitude, slack = 2e-6f * t, sure = sigma.influence * (1 + 1e-5f);
  if (lo >= sure) return {t, t};
  if (hi <= -sure) return {-t, -t};
  return {sigma(lo) - slack, sigma(hi) + slack};
}

/// Flattens one tree.
class Flattener {
 public:
  using Kind = Instruction::Kind;
  explicit Flattener(Program& program) : program_(program) {}

  template <class CompileNested>
  void run(const Node* root, const CompileNested& compile_nested) {
    // An explicit stack: trees may be deeper than the machine's.
    frames_.push_back({root, 0, 0, 0});
    while (!frames_.empty()) {
      if (frames_.back().node->operation()) {
        step();
      } else {
        leaf(*frames_.back().node, compile_nested);
        frames_.pop_back();
      }
    }
  }

 private:
  struct Frame {
    const Node* node;
    std::size_t next = 0;
    std::uint32_t begin = 0, second = 0;
  };

  void emit(Instruction in) {
    if (in.kind == Kind::apply)
      --depth_;
    else if (in.kind != Kind::add)
      ++depth_;
    program_.depth = std::max(program_.depth, depth_);
    program_.code.push_back(in);
  }
  void emit_cloud(const Cloud& cloud) {
    emit({Kind::add, leaf_index(program_.clouds, known_, &cloud), 0, nullptr, 0, 0});
  }
  std::uint32_t here() const { return static_cast<std::uint32_t>(program_.code.size()); }

  template <class CompileNested>
  void leaf(const Node& node, const CompileNested& compile_nested) {
    if (const auto* h = std::get_if<HeightLeaf>(&node.content)) {
      emit({Kind::height, leaf_index(program_.heights, known_, h), 0, nullptr, 0, 0});
    } else if (const auto* d = std::get_if<DomainLeaf>(&node.content)) {
      emit({Kind::domain, leaf_index(program_.domains, known_, d), 0, nullptr, 0, 0});
    } else if (const auto* c = node.cloud()) {
      emit({Kind::constant, 0, 0.f, nullptr, 0, 0});
      emit_cloud(*c);
    } else if (const auto* n = node.nested()) {
      const auto [it, added] = known_.try_emplace(n, static_cast<std::uint32_t>(program_.nested.size()));
      if (added) program_.nested.push_back(compile_nested(*n));
      emit({Kind::nested, it->second, 0, nullptr, 0, 0});
    } else {
      emit({Kind::constant, 0, std::get<float>(node.content), nullptr, 0, 0});
    }
  }

  /// One child of the operation on top, or its end.
  void step() {
    Frame& frame = frames_.back();
    const auto& op = *frame.node->operation();
    const bool blend = op.type->about.name == "blend";
    if (frame.next == 0) frame.begin = here();
    if (frame.next >= 2 && !(blend && op.children[frame.next - 1]->cloud()))
      emit({Kind::apply, 0, op.parameter, &*op.type->combination, frame.begin, frame.second});
    // Blended clouds add straight onto what stands before them.
    while (blend && frame.next >= 1 && frame.next < op.children.size() && op.children[frame.next]->cloud()) {
      emit_cloud(*op.children[frame.next]->cloud());
      ++frame.next;
    }
    if (frame.next == op.children.size()) return frames_.pop_back();
    frame.second = here();
    const Node* child = op.children[frame.next++].get();
    frames_.push_back({child, 0, 0, 0});
  }

  Program& program_;
  std::unordered_map<const void*, std::uint32_t> known_;
  std::vector<Frame> frames_;
  std::size_t depth_ = 0;
};

float typical_reach(const Program& program) {
  double sum = 0;
  std::size_t count = 0;
  for (const Cloud* cloud : program.clouds) {
    sum += cloud->mean_reach() * static_cast<double>(cloud->size());
    count += cloud->size();
  }
  float reach = count ? static_cast<float>(sum / static_cast<double>(count)) : 0.f;
  for (const auto& nested : program.nested) reach = std::max(reach, nested->reach());
  return reach;
}

}  // namespace

std::shared_ptr<const Program> Compiler::program(const NodePtr& root) {
  if (const auto it = programs_.find(root.get()); it != programs_.end()) return it->second;
  auto program = std::make_shared<Program>();
  program->root = root;
  Flattener(*program).run(root.get(), [this](const NestedNode& node) { return nested(node); });
  program->reach = typical_reach(*program);
  programs_.emplace(root.get(), program);
  return program;
}

std::shared_ptr<const Nested> Compiler::nested(const NestedNode& node) {
  if (const auto it = nested_.find(&node); it != nested_.end()) return it->second;
  auto compiled = node.compile(*this);
  nested_.emplace(&node, compiled);
  return compiled;
}

Interval height_range(const HeightLeaf& leaf, float lo, float hi, float scale_lo, float scale_hi, float z0,
                      float z1) {
  const float v0 = lo - z1, v1 = hi - z0;
  const float x0 = v0 < 0 ? v0 * scale_hi : v0 * scale_lo, x1 = v1 < 0 ? v1 * scale_lo : v1 * scale_hi;
  return sigma_range(leaf.sigma, x0, x1);
}

Interval domain_range(const DomainLeaf& leaf, float lo, float hi, float z0, float z1) {
  const float base = leaf.base();
  return sigma_range(leaf.sigma, corner_distance(lo, z0 - base), corner_distance(hi, z1 - base));
}

}  // namespace tafoni::field::impl
