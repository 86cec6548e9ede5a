#pragma once
// Edits as values: what a player does to the ground, in the scene's CRS, and the message that says so.

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "tafoni/math/vec.h"
#include "tafoni/volume/tool.h"

namespace tafoni::runtime {

/// All positions are world, metres.
struct ToolUse {
  volume::Tool tool;  ///< a hull of at most 256 corners
  volume::Edit edit = volume::Edit::remove;
};
/// Takes energy * (1 - (r / radius)^2)^3 off the values around the centre; a negative energy adds.
struct Explosion {
  Vec3d center;
  double radius = 0;
  double energy = 0;  ///< metres of depth; above the band it tears solid rock apart
};
/// Any radially symmetric edit: adds change[i] at r = radius * i / (n - 1), and what is linear in between.
struct Radial {
  Vec3d center;
  double radius = 0;
  std::vector<double> change;  ///< 2 to 4096 values, metres
};
/// The ground as it was at an earlier version. This is an edit like any other: it makes a new version, and
/// what it takes back stays in the journal and can be gone back to. Needs
/// DestructibleTerrainSettings::rewind.
struct Rewind {
  std::uint64_t version = 0;
};
using Operation = std::variant<ToolUse, Explosion, Radial, Rewind>;

/// Little-endian and canonical: the same operation gives the same bytes everywhere, and no other bytes are
/// taken for it. A box's turn travels as cosine and sine, which machines compute differently; so all peers
/// dig the same box. A hull travels without corners that change nothing.
using Message = std::vector<std::byte>;
/// Throws Error{usage} for numbers that make no edit.
Message encode(const Operation& operation);
/// Takes any bytes; throws Error{input} for those that encode() does not give.
Operation decode(std::span<const std::byte> message);

}  // namespace tafoni::runtime
