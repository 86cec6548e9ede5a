#pragma once
// A cloud as it is stored: sorted along a space-filling curve, quantized, indexed by a wide bounding-volume
// tree.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tafoni/field/impl/kernels.h"
#include "tafoni/field/primitive.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

/// A plain primitive: 16 bytes. The anchor is 3 x 21 bits of units within its block's cell of 256 m.
struct PackedPrimitive {
  std::uint64_t anchor;
  float radius;
  float energy;
};
static_assert(sizeof(PackedPrimitive) == 16);

/// Bounds of up to eight children, structure of arrays; absent children are empty boxes.
struct WideBox {
  static constexpr int fan = 8;
  alignas(32) float lo[3][fan], hi[3][fan];
};

struct IndexKernels {
  /// Bit c: child c touches `box`.
  unsigned (*overlaps)(const WideBox&, const Box3f& box);
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

  /// Appends, in canonical order, every primitive whose support may touch `box` (local metres).
  void collect(const Box3f& box, Primitives& out) const;
  /// Adds the range of the whole cloud's value over `box`.
  Interval interval(const Box3f& box, Primitives& scratch) const;
  CloudView view(const Primitives& decoded) const { return {&decoded, pool_.data(), falloff_, noise_}; }
  /// Range of one decoded primitive's contribution over `box`.
  Interval contribution(const Primitives& p, std::size_t i, const Box3f& box) const;

 private:
  static constexpr std::size_t block_size = 16;
  static constexpr int fan = WideBox::fan;
  struct Block {
    std::int16_t cell[3];
    std::uint16_t count;
    std::uint32_t first;
  };
  /// Appends primitive i if its support may touch `box`.
  bool decode(const Block& block, std::size_t i, const Box3f& box, Primitives& out) const;
  float reach_of(float radius, std::span<const float> extras) const;
  void build_index(const std::vector<Box3f>& boxes);

  const PrimitiveType* type_;
  float falloff_;
  Noise noise_;
  std::vector<PackedPrimitive> packed_;
  std::vector<std::uint32_t> extra_offsets_;  ///< size() + 1 for variable kinds, else empty
  std::vector<float> pool_;
  std::vector<Block> blocks_;
  std::vector<std::vector<WideBox>> levels_;  ///< [0] bounds the blocks, the last has one node
  Box3f bounds_;
};

}  // namespace tafoni::field::impl
