// OFF, read only: a count of vertices and faces, their lines, and polygons that become triangles.

#include <algorithm>
#include <string>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/placing.h"
#include "tafoni/io/impl/polygon.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::io::format_off {
namespace {

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  impl::TextCursor cursor(impl::as_text(bytes), file);
  std::string_view word = cursor.token_anywhere();
  if (word == "OFF" || word == "COFF" || word == "NOFF" || word == "CNOFF")
    word = cursor.token_anywhere();
  else if (word.empty() || word.find_first_not_of("0123456789") != word.npos)
    cursor.fail_here("the header OFF is missing");
  if (word == "BINARY") cursor.fail_here("binary OFF is not read; write it as text");
  const std::int64_t vertices = cursor.integer(word);
  const std::int64_t faces = cursor.integer(cursor.token_anywhere());
  cursor.rest_of_line();
  // The shortest vertex is "0 0 0\n" and the shortest face "3 0 1 2\n" or "0\n": a hostile count cannot
  // allocate more than a small multiple of the file.
  const std::int64_t left = cursor.left();
  if (vertices < 0 || faces < 0 || vertices > left / 6 + 1 || faces > left / 2 + 1)
    cursor.fail_here("more vertices or faces are announced than the file can hold");

  mesh::Mesh mesh;
  std::vector<Vec3d> positions;
  positions.reserve(vertices);
  for (std::int64_t i = 0; i < vertices; ++i) {
    Vec3d p;
    p.x = cursor.number(cursor.token_anywhere());
    p.y = cursor.number(cursor.token());
    p.z = cursor.number(cursor.token());
    positions.push_back(p);
    cursor.rest_of_line();
  }
  std::vector<std::uint32_t> polygon;
  impl::PolygonCutter cutter;
  for (std::int64_t i = 0; i < faces; ++i) {
    const std::int64_t corners = cursor.integer(cursor.token_anywhere());
    polygon.clear();
    for (std::int64_t k = 0; k < corners; ++k) {
      const std::int64_t v = cursor.integer(cursor.token());
      if (v < 0 || v >= vertices) cursor.fail_here("a face names a vertex that is not there");
      polygon.push_back(static_cast<std::uint32_t>(v));
    }
    for (const auto& [a, b, c] : cutter.cut(polygon, positions))
      mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    cursor.rest_of_line();
  }
  impl::place(mesh, positions, {});
  return mesh;
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "off",
                .doc = "Object file format, text, read only; polygons become triangles",
                .source = "[OFF]"},
      .extensions = {"off"},
      .read_mesh = read,
  };
  return type;
}

}  // namespace tafoni::io::format_off
