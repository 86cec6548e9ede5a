#include <algorithm>
#include <charconv>
#include <string>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/writing.h"

namespace tafoni::io {
namespace {

constexpr std::string_view origin_key = "# world origin ";

/// Shortest text that reads back to the same float.
void put_number(std::string& block, float value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  block += ' ';
  block.append(text, end);
}

void put_index(std::string& block, std::uint64_t value) {
  char text[24];
  block.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

void write(AtomicFile& out, const mesh::Mesh& mesh, const MeshMetadata& metadata, Progress& progress) {
  out.write(fmt::format("# tafoni: metres, z up\n{}{}\n", origin_key, impl::origin_text(mesh.origin)));
  if (!metadata.crs.empty()) out.write("# crs " + impl::one_line(metadata.crs) + '\n');
  for (const auto& [name, value] : metadata.generator)
    out.write("# " + impl::one_line(name) + " = " + impl::one_line(to_toml(value)) + '\n');
  out.write("o " + impl::one_line(metadata.name) + '\n');
  const bool colored = !mesh.colors.empty(), smooth = !mesh.normals.empty();
  impl::write_items(out, mesh.positions.size(), progress, [&](std::string& block, std::size_t i) {
    block += 'v';
    for (const float x : {mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z})
      put_number(block, x);
    if (colored)
      for (std::size_t k = 0; k < 3; ++k) put_number(block, impl::srgb_from_linear(mesh.colors[i][k]));
    block += '\n';
  });
  Progress& uncounted = silent();
  if (smooth)
    impl::write_items(out, mesh.normals.size(), uncounted, [&](std::string& block, std::size_t i) {
      block += "vn";
      for (const float x : {mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z}) put_number(block, x);
      block += '\n';
    });
  impl::write_items(out, mesh.triangles.size(), progress, [&](std::string& block, std::size_t i) {
    block += 'f';
    for (const std::uint32_t v : mesh.triangles[i]) {
      block += ' ';
      put_index(block, std::uint64_t{v} + 1);
      if (!smooth) continue;
      block += "//";
      put_index(block, std::uint64_t{v} + 1);
    }
    block += '\n';
  });
}

/// Reads v, vn and f; whatever else a file says (groups, materials, texture coordinates) is passed over.
class Reader {
 public:
  Reader(std::string_view text, std::string_view file) : cursor_(text, file) {
    mesh_.origin = impl::find_origin(text.substr(0, 4096), origin_key);
  }

  mesh::Mesh run() {
    while (!cursor_.at_end()) {
      const std::string_view word = cursor_.token();
      if (word == "v")
        vertex();
      else if (word == "vn")
        normals_.push_back(to_float(triple()));
      else if (word == "f")
        face();
      cursor_.rest_of_line();
    }
    if (mesh_.triangles.empty()) cursor_.fail_here("there is no face");
    if (conflict_ || !used_normals_) mesh_.normals.clear();
    return std::move(mesh_);
  }

 private:
  Vec3d triple() {
    Vec3d p;
    for (double* x : {&p.x, &p.y, &p.z}) *x = cursor_.number(cursor_.token());
    return p;
  }

  void vertex() {
    mesh_.positions.push_back(to_float(triple()));
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
    const auto n = static_cast<std::int64_t>(count);
    const std::int64_t v = value < 0 ? n + value : value - 1;
    if (value == 0 || v < 0 || v >= n) cursor_.fail_here(fmt::format("index {} is not defined here", value));
    return static_cast<std::uint32_t>(v);
  }

  void face() {
    polygon_.clear();
    for (std::string_view word = cursor_.token(); !word.empty(); word = cursor_.token()) {
      const std::size_t slash = word.find('/');
      const std::uint32_t v = index(word.substr(0, slash), mesh_.positions.size());
      polygon_.push_back(v);
      if (slash == word.npos) continue;
      const std::size_t second = word.find('/', slash + 1);
      if (second != word.npos && second + 1 < word.size())
        use_normal(v, normals_[index(word.substr(second + 1), normals_.size())]);
    }
    impl::add_fan(mesh_.triangles, polygon_);
  }

  /// A vertex with two normals lies on a hard edge; a smooth normal a vertex cannot say that.
  void use_normal(std::uint32_t v, Vec3f n) {
    used_normals_ = true;
    if (mesh_.normals.size() < mesh_.positions.size()) mesh_.normals.resize(mesh_.positions.size());
    Vec3f& held = mesh_.normals[v];
    if (held == Vec3f{})
      held = n;
    else
      conflict_ |= held != n;
  }

  impl::TextCursor cursor_;
  mesh::Mesh mesh_;
  std::vector<Vec3f> normals_;
  std::vector<std::uint32_t> polygon_;
  bool used_normals_ = false, conflict_ = false;
};

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  return Reader(impl::as_text(bytes), file).run();
}

}  // namespace

const FormatType& format_obj() {
  static const FormatType type{.name = "obj",
                               .doc = "Wavefront text with normals and vertex colours (sRGB), z up",
                               .source = "Wavefront Advanced Visualizer manual, appendix B1",
                               .extensions = {"obj"},
                               .params = {},
                               .write_mesh = write,
                               .read_mesh = read,
                               .write_image = nullptr};
  return type;
}

}  // namespace tafoni::io
