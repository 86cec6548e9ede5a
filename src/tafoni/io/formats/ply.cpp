// PLY: little-endian binary out; text and both byte orders in, whatever the order and types of the
// properties.

#include <algorithm>
#include <limits>
#include <string>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/gdal.h"
#include "tafoni/io/impl/placing.h"
#include "tafoni/io/impl/ply_header.h"
#include "tafoni/io/impl/polygon.h"
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

/// QGIS knows the CRS by "crs:", with the colon. Strict readers take ASCII alone, and the WKT of most CRSs
/// has degree signs in the names of their areas of use.
std::string header_of(const mesh::Mesh& mesh, const MeshOutput& output) {
  const MeshMetadata& metadata = output.metadata;
  const MeshForm& form = output.form;
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  const auto comment = [&](const std::string& text) { header += "comment " + impl::ascii_line(text) + '\n'; };
  comment(impl::axes_text(form));
  if (!form.world) header += std::string(origin_key) + impl::origin_text(mesh.origin) + '\n';
  comment("name " + metadata.name);
  if (!metadata.crs.empty()) comment("crs: " + impl::short_crs(metadata.crs));
  for (const auto& [name, value] : metadata.generator) comment(name + " = " + to_toml(value));
  header += fmt::format("element vertex {}\n", mesh.positions.size());
  for (const char* axis : {"x", "y", "z"})
    header += fmt::format("property {} {}\n", form.world ? "double" : "float", axis);
  if (!mesh.normals.empty())
    for (const char* axis : {"nx", "ny", "nz"}) header += fmt::format("property float {}\n", axis);
  if (!mesh.colors.empty())
    for (const char* channel : {"red", "green", "blue"})
      header += fmt::format("property uchar {}\n", channel);
  header += fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                        mesh.triangles.size());
  return header;
}

void write(AtomicFile& out, const mesh::Mesh& mesh, const MeshOutput& output, Progress& progress) {
  out.write(header_of(mesh, output));
  const auto turned = [&](auto p) { return output.form.up == 'y' ? impl::y_up(p) : p; };
  std::uint8_t srgb[256];
  for (int i = 0; i < 256; ++i)
    srgb[i] = static_cast<std::uint8_t>(impl::srgb_from_linear(static_cast<std::uint8_t>(i)) * 255 + 0.5f);
  impl::write_items(out, mesh.positions.size(), progress, [&](std::string& block, std::size_t i) {
    if (output.form.world)
      impl::put(block, turned(to_double(mesh.positions[i]) + mesh.origin));
    else
      impl::put(block, turned(mesh.positions[i]));
    if (!mesh.normals.empty()) impl::put(block, turned(mesh.normals[i]));
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
    return stored(type);
  }

  /// What nobody needs may be any word in text, as nan, which is no number to next().
  void pass(PlyType type) {
    if (encoding_ != PlyEncoding::text)
      stored(type);
    else if (cursor_.token_anywhere('\0').empty())
      fail_here("a number is missing");
  }

  /// What the mesh can do without, normals and colours, may be nan.
  double next_if_number(PlyType type) {
    if (encoding_ != PlyEncoding::text) return stored(type);
    const std::string_view word = cursor_.token_anywhere('\0');
    return impl::is_no_number(word) ? std::numeric_limits<double>::quiet_NaN() : cursor_.number(word);
  }

  std::uint64_t count(PlyType type) {
    const double n = next(type);
    if (n < 0 || n > 0xffffffff || n != std::floor(n)) fail_here("a list's length makes no sense");
    return static_cast<std::uint64_t>(n);
  }
  [[noreturn]] void fail_here(std::string_view what) const { cursor_.fail_here(what); }

 private:
  double stored(PlyType type) {
    const std::size_t size = impl::size_of(type);
    if (bytes_.size() - at_ < size) cursor_.fail_here("the data ends too early");
    std::byte raw[8];
    std::copy_n(bytes_.begin() + at_, size, raw);
    if (encoding_ == PlyEncoding::big) std::reverse(raw, raw + size);
    at_ += size;
    return convert(raw, type);
  }

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
  for (std::uint64_t i = 0; i < n; ++i) values.pass(property.type);
}

/// What is read before the mesh gets its origin.
struct Given {
  mesh::Mesh mesh;
  std::vector<Vec3d> positions;
};

void read_vertices(Values& values, const PlyElement& element, bool y_up, Given& given) {
  mesh::Mesh& mesh = given.mesh;
  const auto turned = [&](Vec3d p) { return y_up ? impl::z_up(p) : p; };
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
  given.positions.reserve(element.count);
  if (smooth) mesh.normals.reserve(element.count);
  if (colored) mesh.colors.reserve(element.count);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    double v[9] = {};
    for (std::size_t p = 0; p < slot.size(); ++p) {
      if (slot[p] >= 0)
        v[slot[p]] = slot[p] < 3 ? values.next(element.properties[p].type)
                                 : values.next_if_number(element.properties[p].type);
      else
        skip(values, element.properties[p]);
    }
    given.positions.push_back(turned({v[0], v[1], v[2]}));
    if (smooth) mesh.normals.push_back(to_float(turned({v[3], v[4], v[5]})));
    const double scale = whole ? 1.0 / 255 : 1.0;
    if (colored)
      mesh.colors.push_back({impl::linear_from_srgb(v[6] * scale), impl::linear_from_srgb(v[7] * scale),
                             impl::linear_from_srgb(v[8] * scale), 255});
  }
}

void read_faces(Values& values, const PlyElement& element, Given& given) {
  mesh::Mesh& mesh = given.mesh;
  int at = element.find("vertex_indices");
  if (at < 0) at = element.find("vertex_index");
  if (at < 0 || !element.properties[at].list) values.fail_here("a face has no list of vertex_indices");
  mesh.triangles.reserve(element.count);
  std::vector<std::uint32_t> polygon;
  impl::PolygonCutter cutter;
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
      for (const auto& [a, b, c] : cutter.cut(polygon, given.positions))
        mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    }
  }
}

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  const PlyHeader header = impl::read_ply_header(bytes, file);
  const std::string_view text = impl::as_text(bytes).substr(0, header.bytes);
  Given given;
  Values values(bytes, header, file);
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(values, element, impl::says_y_up(text), given);
    } else if (element.name == "face") {
      read_faces(values, element, given);
    } else {
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const PlyProperty& property : element.properties) skip(values, property);
    }
  }
  impl::place(given.mesh, given.positions, impl::find_origin(text, origin_key));
  return std::move(given.mesh);
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
      .world = true,
      .ups = "zy",
  };
  return type;
}

}  // namespace tafoni::io::format_ply
