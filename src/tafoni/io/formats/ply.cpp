// PLY: little-endian binary out; text and both byte orders in, whatever the order and types of the
// properties.

#include <algorithm>
#include <string>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/ply_header.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/writing.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::io::format_ply {
namespace {

using impl::PlyElement;
using impl::PlyEncoding;
using impl::PlyHeader;
using impl::PlyProperty;
using impl::PlyType;

constexpr std::string_view origin_key = "comment world origin ";

std::string header_of(const mesh::Mesh& mesh, const MeshMetadata& metadata) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment tafoni: metres, z up\n";
  header += std::string(origin_key) + impl::origin_text(mesh.origin) + '\n';
  header += "comment name " + impl::one_line(metadata.name) + '\n';
  if (!metadata.crs.empty()) header += "comment crs " + impl::one_line(metadata.crs) + '\n';
  for (const auto& [name, value] : metadata.generator)
    header += "comment " + impl::one_line(name) + " = " + impl::one_line(to_toml(value)) + '\n';
  header += fmt::format("element vertex {}\n", mesh.positions.size());
  for (const char* axis : {"x", "y", "z"}) header += fmt::format("property float {}\n", axis);
  if (!mesh.normals.empty())
    for (const char* axis : {"nx", "ny", "nz"}) header += fmt::format("property float {}\n", axis);
  if (!mesh.colors.empty())
    for (const char* channel : {"red", "green", "blue"})
      header += fmt::format("property uchar {}\n", channel);
  header += fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                        mesh.triangles.size());
  return header;
}

void write(AtomicFile& out, const mesh::Mesh& mesh, const MeshMetadata& metadata, Progress& progress) {
  out.write(header_of(mesh, metadata));
  std::uint8_t srgb[256];
  for (int i = 0; i < 256; ++i)
    srgb[i] = static_cast<std::uint8_t>(impl::srgb_from_linear(static_cast<std::uint8_t>(i)) * 255 + 0.5f);
  impl::write_items(out, mesh.positions.size(), progress, [&](std::string& block, std::size_t i) {
    impl::put(block, mesh.positions[i]);
    if (!mesh.normals.empty()) impl::put(block, mesh.normals[i]);
    if (!mesh.colors.empty())
      for (std::size_t k = 0; k < 3; ++k) impl::put(block, srgb[mesh.colors[i][k]]);
  });
  impl::write_items(out, mesh.triangles.size(), progress, [&](std::string& block, std::size_t i) {
    impl::put(block, std::uint8_t{3});
    impl::put(block, mesh.triangles[i]);
  });
}

/// Reads values one after another in any of the three encodings.
class Values {
 public:
  Values(std::span<const std::byte> bytes, const PlyHeader& header, std::string_view file)
      : bytes_(bytes),
        at_(header.bytes),
        encoding_(header.encoding),
        cursor_(impl::as_text(bytes).substr(header.bytes), file, header.lines) {}

  double next(PlyType type) {
    if (encoding_ == PlyEncoding::text) return cursor_.number(cursor_.token_anywhere('\0'));
    const std::size_t size = impl::size_of(type);
    if (bytes_.size() - at_ < size) cursor_.fail_here("the data ends too early");
    std::byte raw[8];
    std::copy_n(bytes_.begin() + at_, size, raw);
    if (encoding_ == PlyEncoding::big) std::reverse(raw, raw + size);
    at_ += size;
    return convert(raw, type);
  }

  std::uint64_t count(PlyType type) {
    const double n = next(type);
    if (n < 0 || n > 0xffffffff || n != std::floor(n)) fail_here("a list's length makes no sense");
    return static_cast<std::uint64_t>(n);
  }
  [[noreturn]] void fail_here(std::string_view what) const { cursor_.fail_here(what); }

 private:
  static double convert(std::span<const std::byte> raw, PlyType type) {
    switch (type) {
      case PlyType::i8:
        return impl::load<std::int8_t>(raw, 0);
      case PlyType::u8:
        return impl::load<std::uint8_t>(raw, 0);
      case PlyType::i16:
        return impl::load<std::int16_t>(raw, 0);
      case PlyType::u16:
        return impl::load<std::uint16_t>(raw, 0);
      case PlyType::i32:
        return impl::load<std::int32_t>(raw, 0);
      case PlyType::u32:
        return impl::load<std::uint32_t>(raw, 0);
      case PlyType::f32:
        return impl::load<float>(raw, 0);
      case PlyType::f64:
        return impl::load<double>(raw, 0);
    }
    return 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_;
  PlyEncoding encoding_;
  impl::TextCursor cursor_;
};

void skip(Values& values, const PlyProperty& property) {
  const std::uint64_t n = property.list ? values.count(property.count_type) : 1;
  for (std::uint64_t i = 0; i < n; ++i) values.next(property.type);
}

void read_vertices(Values& values, const PlyElement& element, mesh::Mesh& mesh) {
  static constexpr std::string_view names[] = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
  std::vector<int> slot(element.properties.size(), -1);
  bool has[9] = {};
  for (int k = 0; k < 9; ++k) {
    const int at = element.find(names[k]);
    has[k] = at >= 0 && !element.properties[at].list;
    if (has[k]) slot[at] = k;
  }
  if (!has[0] || !has[1] || !has[2]) values.fail_here("a vertex has no x, y and z");
  const bool smooth = has[3] && has[4] && has[5], colored = has[6] && has[7] && has[8];
  const int red = element.find("red");
  const bool whole = colored && element.properties[red].type == PlyType::u8;
  mesh.positions.reserve(element.count);
  if (smooth) mesh.normals.reserve(element.count);
  if (colored) mesh.colors.reserve(element.count);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double v[9] = {};
    for (std::size_t p = 0; p < slot.size(); ++p) {
      if (slot[p] >= 0)
        v[slot[p]] = values.next(element.properties[p].type);
      else
        skip(values, element.properties[p]);
    }
    mesh.positions.push_back(to_float({v[0], v[1], v[2]}));
    if (smooth) mesh.normals.push_back(to_float({v[3], v[4], v[5]}));
    const double scale = whole ? 1.0 / 255 : 1.0;
    if (colored)
      mesh.colors.push_back({impl::linear_from_srgb(v[6] * scale), impl::linear_from_srgb(v[7] * scale),
                             impl::linear_from_srgb(v[8] * scale), 255});
  }
}

void read_faces(Values& values, const PlyElement& element, mesh::Mesh& mesh) {
  int at = element.find("vertex_indices");
  if (at < 0) at = element.find("vertex_index");
  if (at < 0 || !element.properties[at].list) values.fail_here("a face has no list of vertex_indices");
  mesh.triangles.reserve(element.count);
  std::vector<std::uint32_t> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (int p = 0; p < std::ssize(element.properties); ++p) {
      const PlyProperty& property = element.properties[p];
      if (p != at) {
        skip(values, property);
        continue;
      }
      polygon.clear();
      const std::uint64_t corners = values.count(property.count_type);
      for (std::uint64_t k = 0; k < corners; ++k) {
        const double v = values.next(property.type);
        if (!(v >= 0 && v <= 0xffffffff)) values.fail_here("a face names a vertex that is not there");
        polygon.push_back(static_cast<std::uint32_t>(v));
      }
      impl::add_fan(mesh.triangles, polygon);
    }
  }
}

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  const PlyHeader header = impl::read_ply_header(bytes, file);
  mesh::Mesh mesh;
  mesh.origin = impl::find_origin(impl::as_text(bytes).substr(0, header.bytes), origin_key);
  Values values(bytes, header, file);
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(values, element, mesh);
    } else if (element.name == "face") {
      read_faces(values, element, mesh);
    } else {
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const PlyProperty& property : element.properties) skip(values, property);
    }
  }
  return mesh;
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about =
          {.name = "ply",
           .doc =
               "Binary polygons with normals and vertex colours (sRGB), z up; reads text and big-endian too",
           .source = "[PLY]"},
      .extensions = {"ply"},
      .write_mesh = write,
      .read_mesh = read,
  };
  return type;
}

}  // namespace tafoni::io::format_ply
