// Runs a program at points, eight at a time. Memory is lent to a thread from a pool of its own, because a
// nested leaf may ask another program in the middle of this one.

#include "tafoni/field/impl/points.h"

#include <algorithm>
#include <numeric>

namespace tafoni::field::impl {

namespace {

/// Works of this thread; the first `leased` are in use.
struct Pool {
  std::vector<std::unique_ptr<PointWork>> works;
  std::size_t leased = 0;
};
Pool& pool() {
  static thread_local Pool pool;
  return pool;
}
PointWork& lease() {
  Pool& own = pool();
  if (own.leased == own.works.size()) own.works.push_back(std::make_unique<PointWork>());
  return *own.works[own.leased++];
}

}  // namespace

PointWork::PointWork() = default;
PointWork::~PointWork() = default;
PointWork::PointWork(PointWork&&) noexcept = default;
PointWork::Lease::Lease() : work_(lease()) {}
PointWork::Lease::~Lease() {
  --pool().leased;
}

PointWork& PointWork::nested(std::size_t index) {
  if (nested_.size() <= index) nested_.resize(index + 1);
  if (!nested_[index]) nested_[index] = std::make_unique<PointWork>();
  return *nested_[index];
}

void PointWork::values(const Program& program, std::span<const Vec3d> points, float* out) {
  in_packs(program, points, false,
           [&](std::size_t first, std::size_t n) { std::copy_n(values(program), n, out + first); });
}

void PointWork::gradients(const Program& program, std::span<const Vec3d> points, PointValues* out) {
  in_packs(program, points, true,
           [&](std::size_t first, std::size_t) { out[first / pack_size] = gradients(program); });
}

template <class Run>
void PointWork::in_packs(const Program& program, std::span<const Vec3d> points, bool with_gradients,
                         const Run& run) {
  if (points.empty()) return;
  while (group_.size() < points.size()) group_.push_back(static_cast<std::uint32_t>(group_.size()));
  const auto group = std::span<const std::uint32_t>(group_).first(points.size());
  collect(program, points, group);
  ask_nested(program, points, group, with_gradients);
  for (std::size_t i = 0; i < group.size(); i += pack_size) {
    const auto pack = group.subspan(i, std::min(pack_size, group.size() - i));
    load(points, pack, i);
    if (group.size() > pack_size) narrow(program);
    run(i, pack.size());
  }
}

void PointWork::ask_nested(const Program& program, std::span<const Vec3d> points,
                           std::span<const std::uint32_t> group, bool with_gradients) {
  const std::size_t n = program.nested.size();
  if (n == 0) return;
  group_points_.clear();
  for (std::uint32_t i : group) group_points_.push_back(points[i]);
  const std::size_t padded = (group.size() + pack_size - 1) / pack_size * pack_size;
  nested_values_.resize(std::max(nested_values_.size(), n));
  nested_gradients_.resize(nested_values_.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (with_gradients) {
      nested_gradients_[i].resize(padded / pack_size);
      program.nested[i]->gradients(group_points_, nested(i), nested_gradients_[i].data());
    } else {
      auto& values = nested_values_[i];
      values.resize(padded);
      program.nested[i]->values(group_points_, nested(i), values.data());
      std::fill(values.begin() + group.size(), values.end(), values[group.size() - 1]);
    }
  }
}

void PointWork::load(std::span<const Vec3d> points, std::span<const std::uint32_t> pack, std::size_t first) {
  first_ = first;
  for (std::size_t l = 0; l < 8; ++l) {
    const Vec3d& p = points[pack[l < pack.size() ? l : 0]];
    points_[l] = p;
    const Fixed x = to_fixed(p.x), y = to_fixed(p.y), z = to_fixed(p.z);
    lanes_.x[l] = x.units, lanes_.y[l] = y.units, lanes_.z[l] = z.units;
    lanes_.xr[l] = x.rest, lanes_.yr[l] = y.rest, lanes_.zr[l] = z.rest;
  }
}

void PointWork::collect(const Program& program, std::span<const Vec3d> points,
                        std::span<const std::uint32_t> group) {
  Box3f box;
  for (std::uint32_t i : group) box.expand(to_float(points[i]));
  decoded_.resize(std::max(decoded_.size(), program.clouds.size()));
  narrowed_.resize(decoded_.size());
  lists_.clear();
  for (std::size_t c = 0; c < program.clouds.size(); ++c) {
    decoded_[c].clear();
    program.clouds[c]->collect(box, decoded_[c]);
    const std::size_t n = decoded_[c].size();
    if (iota_.size() < n) {
      iota_.resize(n);
      std::iota(iota_.begin(), iota_.end(), 0u);
    }
    lists_.push_back({&decoded_[c], nullptr, n});
  }
  for (List& list : lists_) list.items = iota_.data();
}

void PointWork::narrow(const Program& program) {
  constexpr std::size_t worth_it = 12;  // fewer primitives are summed faster than they are sorted out
  Box3f box;
  for (const Vec3d& p : points_) box.expand(to_float(p));
  for (std::size_t c = 0; c < program.clouds.size(); ++c) {
    const Primitives& p = decoded_[c];
    lists_[c] = {&p, iota_.data(), p.size()};
    if (p.size() < worth_it) continue;
    auto& kept = narrowed_[c];
    kept.resize(p.size() + pack_size);
    const std::size_t n = index_kernels().narrow(p, box, kept.data());
    lists_[c] = {&p, kept.data(), n};
  }
}

const float* PointWork::values(const Program& program) {
  if (value_slots_.size() < program.depth) value_slots_.resize(program.depth);
  const LeafKernels& kernels = leaf_kernels();
  const auto slot = [&](int i) { return value_slots_[i].f; };
  walk(
      program, nullptr,
      [&](int i, const Instruction& in) {
        if (in.kind == Instruction::Kind::height)
          kernels.height_points(*program.heights[in.index], points_, lanes_, slot(i));
        else if (in.kind == Instruction::Kind::domain)
          kernels.domain_points(*program.domains[in.index], points_, lanes_, slot(i));
        else if (in.kind == Instruction::Kind::nested)
          std::copy_n(nested_values_[in.index].data() + first_, pack_size, slot(i));
        else
          std::fill_n(slot(i), 8, in.value);
      },
      [&](int i, const Instruction& in) {
        const List& list = lists_[in.index];
        if (list.count == 0) return;
        const Cloud& cloud = *program.clouds[in.index];
        cloud.type().kernels().add_points(cloud.view(*list.primitives), list.items, list.count, lanes_,
                                          slot(i));
      },
      [&](int i, const Instruction& in) { in.op->kernels().points(slot(i), slot(i + 1), in.value); });
  return slot(0);
}

const PointValues& PointWork::gradients(const Program& program) {
  if (gradient_slots_.size() < program.depth) gradient_slots_.resize(program.depth);
  const LeafKernels& kernels = leaf_kernels();
  const auto slot = [&](int i) -> PointValues& { return gradient_slots_[i]; };
  walk(
      program, nullptr,
      [&](int i, const Instruction& in) {
        if (in.kind == Instruction::Kind::height) {
          kernels.height_gradients(*program.heights[in.index], points_, lanes_, slot(i));
        } else if (in.kind == Instruction::Kind::domain) {
          kernels.domain_gradients(*program.domains[in.index], points_, lanes_, slot(i));
        } else if (in.kind == Instruction::Kind::nested) {
          slot(i) = nested_gradients_[in.index][first_ / pack_size];
        } else {
          slot(i) = {};
          std::fill_n(slot(i).v, 8, in.value);
        }
      },
      [&](int i, const Instruction& in) {
        const List& list = lists_[in.index];
        if (list.count == 0) return;
        const Cloud& cloud = *program.clouds[in.index];
        cloud.type().kernels().add_gradients(cloud.view(*list.primitives), list.items, list.count, lanes_,
                                             slot(i));
      },
      [&](int i, const Instruction& in) { in.op->kernels().gradients(slot(i), slot(i + 1), in.value); });
  return slot(0);
}

}  // namespace tafoni::field::impl
