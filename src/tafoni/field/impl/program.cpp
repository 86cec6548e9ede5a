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

/// The polynomial of sigma is monotone; its float evaluation to a few parts in 10^7.
Interval widened(Interval r, float amplitude) {
  const float slack = 2e-6f * amplitude;
  return {r.lo - slack, r.hi + slack};
}

}  // namespace

Program flatten(const NodePtr& root) {
  Program program;
  program.root = root;
  std::unordered_map<const void*, std::uint32_t> known;
  using Kind = Instruction::Kind;

  // An explicit stack: trees may be deeper than the machine's.
  struct Frame {
    const Node* node;
    std::size_t next = 0;
    std::uint32_t begin = 0, second = 0;
  };
  std::vector<Frame> frames{{root.get(), 0, 0, 0}};
  std::size_t depth = 0;
  const auto emit = [&](Instruction in) {
    if (in.kind == Kind::apply) --depth;
    if (in.kind == Kind::height || in.kind == Kind::domain || in.kind == Kind::constant) ++depth;
    program.depth = std::max(program.depth, depth);
    program.code.push_back(in);
  };
  const auto here = [&] { return static_cast<std::uint32_t>(program.code.size()); };
  const auto emit_cloud = [&](const Cloud& cloud) {
    emit({Kind::add, leaf_index(program.clouds, known, &cloud), 0, nullptr, 0, 0});
  };

  while (!frames.empty()) {
    Frame& frame = frames.back();
    const Node& node = *frame.node;
    const auto* op = node.operation();
    if (!op) {
      if (const auto* h = std::get_if<HeightLeaf>(&node.content)) {
        emit({Kind::height, leaf_index(program.heights, known, h), 0, nullptr, 0, 0});
      } else if (const auto* d = std::get_if<DomainLeaf>(&node.content)) {
        emit({Kind::domain, leaf_index(program.domains, known, d), 0, nullptr, 0, 0});
      } else if (const auto* c = node.cloud()) {
        emit({Kind::constant, 0, 0.f, nullptr, 0, 0});
        emit_cloud(*c);
      } else {
        emit({Kind::constant, 0, std::get<float>(node.content), nullptr, 0, 0});
      }
      frames.pop_back();
      continue;
    }
    if (frame.next == 0) frame.begin = here();
    if (frame.next >= 2) {
      const Node& last = *op->children[frame.next - 1];
      if (op->type->name != "blend" || !last.cloud())
        emit({Kind::apply, 0, 0, op->type, frame.begin, frame.second});
    }
    // Blended clouds add straight onto what stands before them.
    while (frame.next >= 1 && frame.next < op->children.size() && op->type->name == "blend" &&
           op->children[frame.next]->cloud()) {
      emit_cloud(*op->children[frame.next]->cloud());
      ++frame.next;
    }
    if (frame.next == op->children.size()) {
      frames.pop_back();
      continue;
    }
    frame.second = here();
    const Node* child = op->children[frame.next++].get();
    frames.push_back({child, 0, 0, 0});
  }
  return program;
}

float typical_reach(const Program& program) {
  double sum = 0;
  std::size_t count = 0;
  for (const Cloud* cloud : program.clouds) {
    sum += static_cast<double>(cloud->mean_reach()) * static_cast<double>(cloud->size());
    count += cloud->size();
  }
  return count ? static_cast<float>(sum / static_cast<double>(count)) : 0.f;
}

Interval height_range(const HeightLeaf& leaf, float lo, float hi, float scale_lo, float scale_hi, float z0,
                      float z1) {
  const float v0 = lo - z1, v1 = hi - z0;
  const float x0 = v0 < 0 ? v0 * scale_hi : v0 * scale_lo, x1 = v1 < 0 ? v1 * scale_lo : v1 * scale_hi;
  return widened({leaf.sigma(x0), leaf.sigma(x1)}, leaf.sigma.amplitude);
}

Interval domain_range(const DomainLeaf& leaf, float lo, float hi, float z0, float z1) {
  const float base = static_cast<float>(leaf.domain.box.lo.z);
  return widened({leaf.sigma(corner_distance(lo, z0 - base)), leaf.sigma(corner_distance(hi, z1 - base))},
                 leaf.sigma.amplitude);
}

}  // namespace tafoni::field::impl
