// STL: triangles with no vertices in common, which the reader welds; the header's 80 bytes hold the world
// origin. Binary out, binary and text in.

#include <algorithm>
#include <array>
#include <string>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/placing.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/writing.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::io::format_stl {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;
constexpr std::string_view origin_key = "origin ";

void write(AtomicFile& out, const mesh::Mesh& mesh, const MeshOutput& output, Progress& progress) {
  if (mesh.triangles.size() > 0xffffffffull)
    fail(ErrorKind::output, "STL holds at most 2^32 triangles and the mesh has {}; write PLY or simplify it.",
         mesh.triangles.size());
  // The header must not begin with "solid", or readers would take the file for text.
  std::string header =
      impl::axes_text(output.form) + ", " + std::string(origin_key) + impl::origin_text(mesh.origin);
  header.resize(80, ' ');
  impl::put(header, static_cast<std::uint32_t>(mesh.triangles.size()));
  out.write(header);
  impl::write_items(out, mesh.triangles.size(), progress, [&](std::string& block, std::size_t i) {
    const auto& t = mesh.triangles[i];
    const auto corner = [&](std::size_t k) {
      const Vec3f p = mesh.positions[t[k]];
      return output.form.up == 'y' ? impl::y_up(p) : p;
    };
    const Vec3f a = corner(0), b = corner(1), c = corner(2);
    impl::put(block, normalized(cross(b - a, c - a)));
    impl::put(block, a);
    impl::put(block, b);
    impl::put(block, c);
    impl::put(block, std::uint16_t{0});
  });
}

mesh::Mesh read_text(std::string_view text, std::string_view file) {
  mesh::Mesh mesh;
  impl::TextCursor cursor(text, file);
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> corners;
  cursor.rest_of_line();
  // Some CAD programs write the words in capitals.
  for (std::string word; !(word = impl::lower_case(cursor.token_anywhere('\0'))).empty();) {
    if (word == "vertex") {
      Vec3d p;
      for (double* x : {&p.x, &p.y, &p.z}) *x = cursor.number(cursor.token('\0'));
      corners.push_back(static_cast<std::uint32_t>(positions.size()));
      positions.push_back(p);
    } else if (word == "endloop") {
      if (corners.size() != 3) cursor.fail_here("a facet does not have three vertices");
      mesh.triangles.push_back({corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (word == "endsolid" || word == "solid") {
      cursor.rest_of_line();
    }
  }
  if (mesh.triangles.empty() || !corners.empty()) cursor.fail_here("the text ends within a facet");
  // Vertices are the same when they round to the same floats, which takes the origin off them first.
  impl::place(mesh, positions, {});
  std::vector<Vec3f> welded;
  impl::Welder welder(welded, mesh.triangles.size());
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) v = welder.add(mesh.positions[v]);
  mesh.positions = std::move(welded);
  return mesh;
}

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  const std::size_t count =
      bytes.size() >= header_bytes ? impl::load<std::uint32_t>(bytes, header_bytes - 4) : 0;
  // Some writers begin binary files with "solid" too; only the size tells.
  const bool binary_size =
      bytes.size() >= header_bytes && bytes.size() >= header_bytes + count * triangle_bytes && count > 0;
  if (!binary_size && impl::lower_case(impl::as_text(bytes).substr(0, 5)) == "solid")
    return read_text(impl::as_text(bytes), file);
  if (!binary_size)
    fail(ErrorKind::input, "{}: an STL file of {} triangles is longer than these {} bytes; it is truncated.",
         file, count, bytes.size());
  mesh::Mesh mesh;
  const std::string_view header = impl::as_text(bytes).substr(0, 80);
  const bool y_up = impl::says_y_up(header);
  mesh.triangles.resize(count);
  impl::Welder welder(mesh.positions, count / 2);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto p = impl::load<Vec3f>(bytes, header_bytes + i * triangle_bytes + 12 + 12 * k);
      mesh.triangles[i][k] = welder.add(y_up ? impl::z_up(p) : p);
    }
  impl::place(mesh, impl::find_origin(header, origin_key));
  return mesh;
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "stl",
                .doc = "Triangles alone for print and CAD, binary; the world origin stands in the header",
                .source = "[STL]"},
      .extensions = {"stl"},
      .write_mesh = write,
      .read_mesh = read,
      .ups = "zy",
  };
  return type;
}

}  // namespace tafoni::io::format_stl
