#pragma once
// A cloud as it is stored: sorted along a space-filling curve, quantized, indexed by a wide bounding-volume
// tree.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tafoni/field/impl/box_tree.h"
#include "tafoni/field/impl/kernels.h"
#include "tafoni/field/primitive.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

/// Plain primitives, 16 bytes each: the anchor is 3 x 21 bits of units within its block's cell of 256 m, x in
/// the low 21 bits of `lo`, y in the high 11 of `lo` and the low 10 of `hi`, z above.
struct Packed {
  std::vector<std::uint32_t> lo, hi;
  std::vector<float> radius, energy;
  std::size_t size() const { return lo.size(); }
};

/// Primitives [first, first + count) of one block, for decoding.
struct PackedRange {
  const Packed* packed;
  std::size_t first, count;
  Vec3i cell;    ///< units
  float beyond;  ///< reach = (radius + beyond), padded
};

/// Rounding in the kernels is a few parts in 10^7; beyond this the contribution is exactly zero.
inline constexpr float reach_factor = 1.f + 1e-5f, reach_margin = 2e-4f;

struct IndexKernels {
  /// Decodes plain primitives and appends those whose support may touch `box`.
  void (*decode)(const PackedRange&, const Box3f& box, Primitives& out);
  /// Writes the indices of those whose support may touch `box`, ascending; returns how many. `out` has room
  /// for eight more than there are primitives.
  std::size_t (*narrow)(const Primitives&, const Box3f& box, std::uint32_t* out);
};
const IndexKernels& index_kernels();

class Cloud {
 public:
  struct Record {
    Vec3i anchor;  ///< units
    float radius, energy;
    std::uint32_t extra, extra_count;  ///< into `pool`
  };

  Cloud(const PrimitiveType& type, float falloff, const Noise& noise, std::vector<Record> records,
        const std::vector<float>& pool);

  const PrimitiveType& type() const { return *type_; }
  std::size_t size() const { return packed_.size(); }
  std::uint64_t bytes() const;
  const Box3f& bounds() const { return bounds_; }
  float mean_reach() const { return mean_reach_; }

  /// Appends, in canonical order, every primitive whose support may touch `box` (local metres).
  void collect(const Box3f& box, Primitives& out) const;
  /// Adds the range of the whole cloud's value over `box`.
  Interval interval(const Box3f& box, Primitives& scratch) const;
  CloudView view(const Primitives& decoded) const { return {&decoded, pool_.data(), falloff_, noise_}; }
  /// Range of one decoded primitive's contribution over `box`.
  Interval contribution(const Primitives& p, std::size_t i, const Box3f& box) const;

 private:
  static constexpr std::size_t block_size = 16;
  struct Block {
    std::int16_t cell[3];
    std::uint16_t count;
    std::uint32_t first;
  };
  struct Distances {
    float near, far;
  };
  /// Least and greatest distance of the box's points from a decoded primitive's skeleton.
  Distances distances(const Primitives& p, std::size_t i, const Box3f& box) const;
  /// Adds reach and extras to decoded primitives of a kind that has extras, and drops what cannot touch
  /// `box`.
  void decode_extras(const Block& block, const Box3f& box, std::size_t from, Primitives& out) const;
  float reach_of(float radius, std::span<const float> extras) const;

  const PrimitiveType* type_;
  float falloff_;
  Noise noise_;
  Packed packed_;
  std::vector<std::uint32_t> extra_offsets_;  ///< size() + 1 for variable kinds, else empty
  std::vector<float> pool_;
  std::vector<Block> blocks_;
  BoxTree tree_;  ///< over the blocks
  Box3f bounds_;
  float mean_reach_ = 0;
};

}  // namespace tafoni::field::impl
