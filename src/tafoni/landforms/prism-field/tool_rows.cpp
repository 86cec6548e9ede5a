// One row is one tool; which of its columns count depends on the tool's shape.

#include "tafoni/landforms/prism-field/tool_rows.h"

#include <numbers>

#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/landforms/site/table_rows.h"

namespace tafoni::landforms::impl {

using volume::Edit;
using volume::Tool;

namespace {

Tool tool_of(const Row& row, Vec3d origin, const std::string& where) {
  const auto place = [&](const char* column) { return point_in(row, column, where) - origin; };
  const auto number = [&](const char* column) { return required_number_in(row, column, where); };
  const std::string_view kind = text_in(row, "tool");
  if (kind == "sphere") return Tool::sphere(place("at"), number("radius"));
  if (kind == "capsule") return Tool::capsule(place("at"), place("to"), number("radius"));
  if (kind == "box")
    return Tool::box(place("at"), point_in(row, "size", where) * 0.5,
                     number("turn") * std::numbers::pi / 180);
  const std::vector<double> all = numbers_in(text_in(row, "points")).value_or(std::vector<double>{});
  if (all.size() < 12 || all.size() % 3 != 0)
    fail(ErrorKind::usage, "{}: a hull needs points, three numbers each, four or more", where);
  std::vector<Vec3d> points;
  for (std::size_t n = 0; n < all.size(); n += 3)
    points.push_back(Vec3d{all[n], all[n + 1], all[n + 2]} - origin);
  try {
    return Tool::hull(points);
  } catch (const Error& error) {
    fail(ErrorKind::usage, "{}: {}", where, error.what());
  }
}

}  // namespace

std::vector<ParamInfo> tool_columns() {
  return {choice_column("tool", "sphere", {"sphere", "capsule", "box", "hull"}, "Its shape"),
          choice_column("mode", "remove", {"remove", "add"}, "Whether it takes matter out or puts it there"),
          numbers_column("at", "", "m", 3, -1e9, 1e9, "Its middle, x, y and z; of a capsule, one end"),
          numbers_column("to", "", "m", 3, -1e9, 1e9, "Of a capsule, the other end"),
          numbers_column("radius", "", "m", 1, 0.001, 10000, "Of a sphere or a capsule"),
          numbers_column("size", "", "m", 3, 0.001, 10000, "Sides of a box along x, y and z"),
          numbers_column("turn", "0", "deg", 1, -3600, 3600,
                         "Of a box, how far it is turned about the vertical, counter-clockwise from above"),
          numbers_column("points", "", "m", 0, -1e9, 1e9, "Of a hull, x, y and z of each, at least four")};
}

std::vector<ToolUse> tools_of(const Rows& rows, Vec3d origin, std::string_view where) {
  std::vector<ToolUse> out;
  for (std::size_t n = 0; n < rows.size(); ++n)
    out.push_back({tool_of(rows[n], origin, fmt::format("{}: tool, row {}", where, n + 1)),
                   text_in(rows[n], "mode") == "add" ? Edit::add : Edit::remove});
  return out;
}

}  // namespace tafoni::landforms::impl
