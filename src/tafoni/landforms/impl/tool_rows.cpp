#include "tafoni/landforms/impl/tool_rows.h"

#include <charconv>
#include <numbers>

#include <fmt/core.h>

#include "tafoni/core/error.h"

namespace tafoni::landforms::impl {

using volume::Edit;
using volume::Tool;

namespace {

class Reader {
 public:
  Reader(const Row& row, std::string where, Vec3d origin)
      : row_(row), where_(std::move(where)), origin_(origin) {}

  ToolUse use() const {
    const std::string& mode = text("mode");
    if (mode != "remove" && mode != "add")
      fail(ErrorKind::usage, "{}: mode = \"{}\" is neither remove nor add", where_, mode);
    try {
      return {tool(), mode == "remove" ? Edit::remove : Edit::add};
    } catch (const Error& error) {
      const std::string_view what = error.what();
      if (what.starts_with(where_)) throw;
      fail(ErrorKind::usage, "{}: {}", where_, what);
    }
  }

 private:
  const std::string& text(const char* column) const { return row_.find(column)->second; }

  std::vector<double> numbers(const char* column) const {
    std::vector<double> out;
    const std::string& all = text(column);
    const char *at = all.data(), *end = at + all.size();
    while (at != end) {
      if (*at == ' ' || *at == ',' || *at == '\t') {
        ++at;
        continue;
      }
      double value = 0;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc{})
        fail(ErrorKind::usage, "{}: {} = \"{}\" is not a list of numbers", where_, column, all);
      out.push_back(value);
      at = next;
    }
    return out;
  }
  std::vector<double> some(const char* column, std::size_t count) const {
    const std::vector<double> out = numbers(column);
    if (out.size() != count)
      fail(ErrorKind::usage, "{}: {} = \"{}\" should be {} number{}", where_, column, text(column), count,
           count == 1 ? "" : "s");
    return out;
  }
  double number(const char* column) const { return some(column, 1)[0]; }
  Vec3d vector(const char* column) const {
    const auto v = some(column, 3);
    return {v[0], v[1], v[2]};
  }
  Vec3d place(const char* column) const { return vector(column) - origin_; }

  Tool tool() const {
    const std::string& kind = text("tool");
    if (kind == "sphere") return Tool::sphere(place("at"), number("radius"));
    if (kind == "capsule") return Tool::capsule(place("at"), place("to"), number("radius"));
    if (kind == "box")
      return Tool::box(place("at"), vector("size") * 0.5, number("turn") * std::numbers::pi / 180);
    if (kind == "hull") {
      const std::vector<double> all = numbers("points");
      std::vector<Vec3d> points;
      for (std::size_t n = 0; n + 2 < all.size(); n += 3)
        points.push_back(Vec3d{all[n], all[n + 1], all[n + 2]} - origin_);
      if (all.size() % 3) fail(ErrorKind::usage, "{}: points should be three numbers a point", where_);
      return Tool::hull(points);
    }
    fail(ErrorKind::usage, "{}: tool = \"{}\" is none of sphere, capsule, box and hull", where_, kind);
  }

  const Row& row_;
  std::string where_;
  Vec3d origin_;
};

}  // namespace

std::vector<ParamInfo> tool_columns() {
  return {column("tool", "sphere", "sphere, capsule, box or hull"),
          column("mode", "remove", "remove or add"),
          column("at", "", "x, y and z of its middle, of a capsule of one end"),
          column("to", "", "of a capsule's other end"),
          column("radius", "", "of a sphere or a capsule, m"),
          column("size", "", "sides of a box along x, y and z, m"),
          column("turn", "0", "of a box about the vertical, counter-clockwise from above, degrees"),
          column("points", "", "of a hull: x, y and z of each, at least four")};
}

std::vector<ToolUse> tools_of(const Rows& rows, Vec3d origin, std::string_view where) {
  std::vector<ToolUse> out;
  for (std::size_t n = 0; n < rows.size(); ++n)
    out.push_back(Reader(rows[n], fmt::format("{}, tool {}", where, n + 1), origin).use());
  return out;
}

}  // namespace tafoni::landforms::impl
