#pragma once
// Tables of points as text: explicit primitives, seed points, query points. Fields are separated by commas,
// semicolons, tabs, bars or blanks, as the first line has them; with other separators than commas decimal
// commas are read, too. Fields may stand in quotes.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "tafoni/field/primitive.h"
#include "tafoni/math/vec.h"

namespace tafoni::io {

/// One primitive of a primitives file [Paris19 §5.2]: adds energy * g(distance).
struct Primitive {
  const field::PrimitiveType* kind = nullptr;
  Vec3d position;              ///< world, scene CRS, metres
  std::vector<Vec3d> further;  ///< of a kind that is a chain of vertices: those after `position`
  std::vector<float> shape;    ///< the kind's parameters; of a chain of vertices the radius alone
  float energy = 0;            ///< metres; negative carves
  std::uint32_t line = 0;
};

/// Columns in any order, named by a header: kind, x, y, z, energy, and the parameters of the kinds as they
/// are registered. A parameter without a column, or with an empty field, has its default. A kind that is a
/// chain of vertices has one row a vertex, rows of one `id` after another; its energy and radius stand in the
/// first. Blank lines and lines that begin with # are skipped. `name` is for messages; no file is opened.
/// Throws Error{input} "NAME:LINE: …".
std::vector<Primitive> parse_primitives_csv(std::string_view text, std::string_view name);

/// Columns named by a header, others ignored; or no header and the first columns, after which only text may
/// follow. One row of numbers a line, in the order of `columns`. `lines` gets the number of each row's line.
std::vector<std::vector<double>> parse_numbers_csv(std::string_view text, std::string_view name,
                                                   std::span<const std::string_view> columns,
                                                   std::vector<std::uint32_t>* lines = nullptr);
/// The same with the columns x, y, z.
std::vector<Vec3d> parse_points_csv(std::string_view text, std::string_view name);

/// The whole of a regular file, or of standard input where the path is "-". Throws Error{input} when it
/// cannot be read or is larger than `limit` bytes.
std::string read_text(const std::filesystem::path& path, std::uint64_t limit = std::uint64_t{1} << 32);

}  // namespace tafoni::io
