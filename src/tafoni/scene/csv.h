#pragma once
// Tables of points as comma-separated text: explicit primitives, seed points, query points.

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::scene {

/// One row of a primitives file (DESIGN 6): adds energy * g(distance).
struct Primitive {
  bool sphere = false;  ///< constant inside the radius, falling off over the terrain's R; else a point,
                        ///< whose falloff is the radius
  Vec3d position;       ///< world, scene CRS, metres
  float radius = 0;     ///< metres
  float energy = 0;     ///< metres; negative carves
  std::uint32_t line = 0;
};

/// Columns kind, x, y, z, radius, energy in any order, named by a header; blank lines and lines that begin
/// with # are skipped. `name` is for messages; no file is opened. Throws Error{input} "NAME:LINE: …".
std::vector<Primitive> parse_primitives_csv(std::string_view text, std::string_view name);

/// Columns x, y, z named by a header, other columns ignored; or no header and the first three columns.
std::vector<Vec3d> parse_points_csv(std::string_view text, std::string_view name);

/// The whole file. Throws Error{input} when it cannot be read or is larger than `limit` bytes.
std::string read_text(const std::filesystem::path& file, std::uint64_t limit = std::uint64_t{1} << 32);

}  // namespace tafoni::scene
