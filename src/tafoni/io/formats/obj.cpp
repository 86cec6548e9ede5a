// Wavefront OBJ: text with the shortest numbers that read back the same; colours follow the position. The
// reader takes what a mesh can hold and passes over the rest.

#include <algorithm>
#include <charconv>
#include <string>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/placing.h"
#include "tafoni/io/impl/polygon.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/seams.h"
#include "tafoni/io/impl/writing.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::io::format_obj {
namespace {

constexpr std::string_view origin_key = "# world origin ";

/// Shortest text that reads back to the same number.
template <class T>
void put_number(std::string& block, T value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  block += ' ';
  block.append(text, end);
}

void put_index(std::string& block, std::uint64_t value) {
  char text[24];
  block.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

template <class T>
void put_numbers(std::string& block, Vec3<T> p) {
  for (const T x : {p.x, p.y, p.z}) put_number(block, x);
}

void write(AtomicFile& out, const mesh::Mesh& mesh, const MeshOutput& output, Progress& progress) {
  const MeshMetadata& metadata = output.metadata;
  const MeshForm& form = output.form;
  out.write("# " + impl::axes_text(form) + '\n');
  if (!form.world) out.write(fmt::format("{}{}\n", origin_key, impl::origin_text(mesh.origin)));
  if (!metadata.crs.empty()) out.write("# crs " + impl::one_line(metadata.crs) + '\n');
  for (const auto& [name, value] : metadata.generator)
    out.write("# " + impl::one_line(name) + " = " + impl::one_line(to_toml(value)) + '\n');
  out.write("o " + impl::one_line(metadata.name) + '\n');
  const bool colored = !mesh.colors.empty(), smooth = !mesh.normals.empty();
  const auto turned = [&](auto p) { return form.up == 'y' ? impl::y_up(p) : p; };
  impl::write_items(out, mesh.positions.size(), progress, [&](std::string& block, std::size_t i) {
    block += 'v';
    if (form.world)
      put_numbers(block, turned(to_double(mesh.positions[i]) + mesh.origin));
    else
      put_numbers(block, turned(mesh.positions[i]));
    if (colored)
      for (std::size_t k = 0; k < 3; ++k) put_number(block, impl::srgb_from_linear(mesh.colors[i][k]));
    block += '\n';
  });
  Progress& uncounted = silent();
  if (smooth)
    impl::write_items(out, mesh.normals.size(), uncounted, [&](std::string& block, std::size_t i) {
      block += "vn";
      put_numbers(block, turned(mesh.normals[i]));
      block += '\n';
    });
  const impl::Seams texture(mesh);
  const bool textured = !texture.corners.empty();
  impl::write_items(out, texture.pairs.size(), uncounted, [&](std::string& block, std::size_t i) {
    block += "vt";
    for (const float x : {texture.pairs[i].x, texture.pairs[i].y}) put_number(block, x);
    block += '\n';
  });
  impl::write_items(out, mesh.triangles.size(), progress, [&](std::string& block, std::size_t i) {
    block += 'f';
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint64_t v = std::uint64_t{mesh.triangles[i][c]} + 1;
      block += ' ';
      put_index(block, v);
      if (!smooth && !textured) continue;
      block += '/';
      if (textured) put_index(block, std::uint64_t{texture.corners[i][c]} + 1);
      if (!smooth) continue;
      block += '/';
      put_index(block, v);
    }
    block += '\n';
  });
}

/// Reads v, vt, vn and f; whatever else a file says (groups, materials) is passed over.
class Reader {
 public:
  Reader(std::string_view text, std::string_view file)
      : cursor_(text, file),
        origin_(impl::find_origin(text.substr(0, 4096), origin_key)),
        y_up_(impl::says_y_up(text.substr(0, 4096))) {}

  mesh::Mesh run() {
    while (!cursor_.at_end()) {
      const std::string_view word = cursor_.token();
      if (word == "v")
        vertex();
      else if (word == "vn")
        normals_.push_back(to_float(turned_triple()));
      else if (word == "vt")
        pair();
      else if (word == "f")
        face();
      cursor_.rest_of_line();
    }
    if (mesh_.triangles.empty()) cursor_.fail_here("there is no face");
    if (conflict_ || !used_normals_) mesh_.normals.clear();
    if (untextured_) mesh_.texture.clear();
    impl::place(mesh_, positions_, origin_);
    return std::move(mesh_);
  }

 private:
  Vec3d turned_triple() {
    Vec3d p;
    for (double* x : {&p.x, &p.y, &p.z}) *x = cursor_.number(cursor_.token());
    return y_up_ ? impl::z_up(p) : p;
  }

  void pair() {
    Vec2<float> p;
    p.x = static_cast<float>(cursor_.number(cursor_.token()));
    const std::string_view second = cursor_.token();
    if (!second.empty()) p.y = static_cast<float>(cursor_.number(second));
    pairs_.push_back(p);
  }

  void vertex() {
    positions_.push_back(turned_triple());
    double rgb[3] = {};
    int given = 0;
    for (std::string_view word = cursor_.token(); given < 3 && !word.empty(); word = cursor_.token())
      rgb[given++] = cursor_.number(word);
    // One value more than a position is a weight, not a colour.
    if (given == 3)
      mesh_.colors.push_back({impl::linear_from_srgb(rgb[0]), impl::linear_from_srgb(rgb[1]),
                              impl::linear_from_srgb(rgb[2]), 255});
  }

  std::uint32_t index(std::string_view word, std::size_t count) const {
    const std::int64_t value = cursor_.integer(word);
    const std::int64_t n = count;
    const std::int64_t v = value < 0 ? n + value : value - 1;
    if (value == 0 || v < 0 || v >= n) cursor_.fail_here(fmt::format("index {} is not defined here", value));
    return static_cast<std::uint32_t>(v);
  }

  void face() {
    polygon_.clear();
    corners_.clear();
    for (std::string_view word = cursor_.token(); !word.empty(); word = cursor_.token()) {
      const std::size_t slash = word.find('/');
      const std::uint32_t v = index(word.substr(0, slash), positions_.size());
      polygon_.push_back(v);
      if (slash == word.npos) continue;
      const std::size_t second = word.find('/', slash + 1);
      const std::string_view pair = word.substr(slash + 1, second - slash - 1);
      if (!pair.empty()) corners_.push_back(pairs_[index(pair, pairs_.size())]);
      if (second != word.npos && second + 1 < word.size())
        use_normal(v, normals_[index(word.substr(second + 1), normals_.size())]);
    }
    untextured_ |= corners_.size() != polygon_.size();
    for (const auto& [a, b, c] : cutter_.cut(polygon_, positions_)) {
      mesh_.triangles.push_back({polygon_[a], polygon_[b], polygon_[c]});
      if (!untextured_) mesh_.texture.push_back({corners_[a], corners_[b], corners_[c]});
    }
  }

  /// A vertex with two normals lies on a hard edge; a smooth normal a vertex cannot say that.
  void use_normal(std::uint32_t v, Vec3f n) {
    used_normals_ = true;
    if (mesh_.normals.size() < positions_.size()) mesh_.normals.resize(positions_.size());
    Vec3f& held = mesh_.normals[v];
    if (held == Vec3f{})
      held = n;
    else
      conflict_ |= held != n;
  }

  impl::TextCursor cursor_;
  std::optional<Vec3d> origin_;
  bool y_up_ = false;
  mesh::Mesh mesh_;
  std::vector<Vec3d> positions_;
  std::vector<Vec3f> normals_;
  std::vector<std::uint32_t> polygon_;
  impl::PolygonCutter cutter_;
  std::vector<Vec2<float>> pairs_, corners_;
  bool used_normals_ = false, conflict_ = false;
  bool untextured_ = false;  ///< a corner has no texture coordinates
};

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  return Reader(impl::as_text(bytes), file).run();
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "obj",
                .doc = "Wavefront text with normals, texture coordinates and vertex colours (sRGB), y up",
                .source = "[OBJ]"},
      .extensions = {"obj"},
      .write_mesh = write,
      .read_mesh = read,
      .texture = true,
      .world = true,
      .ups = "yz",
  };
  return type;
}

}  // namespace tafoni::io::format_obj
