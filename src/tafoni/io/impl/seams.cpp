// Corners' texture coordinates as a list that vertices share, by a chain of coordinates a vertex; and
// back.

#include "tafoni/io/impl/seams.h"

namespace tafoni::io::impl {

Seams::Seams(const mesh::Mesh& mesh) {
  if (mesh.texture.empty()) return;
  constexpr std::uint32_t none = 0xffffffff;
  struct Entry {
    Vec2<float> pair;
    std::uint32_t next;
  };
  std::vector<std::uint32_t> first(mesh.positions.size(), none);
  std::vector<Entry> entries;
  corners.resize(mesh.texture.size());
  for (std::size_t t = 0; t < mesh.texture.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec2<float> pair = mesh.texture[t][c];
      std::uint32_t& begin = first[mesh.triangles[t][c]];
      std::uint32_t at = begin;
      while (at != none && entries[at].pair != pair) at = entries[at].next;
      if (at == none) {
        at = static_cast<std::uint32_t>(entries.size());
        entries.push_back({pair, begin});
        begin = at;
      }
      corners[t][c] = at;
    }
  std::vector<std::uint32_t> place(entries.size());
  pairs.reserve(entries.size());
  vertex.reserve(entries.size());
  for (std::uint32_t v = 0; v < first.size(); ++v)
    for (std::uint32_t at = first[v]; at != none; at = entries[at].next) {
      place[at] = static_cast<std::uint32_t>(pairs.size());
      pairs.push_back(entries[at].pair);
      vertex.push_back(v);
    }
  for (auto& triangle : corners)
    for (std::uint32_t& corner : triangle) corner = place[corner];
}

void join_seams(mesh::Mesh& mesh, const std::vector<Vec2<float>>& pairs) {
  mesh.texture.clear();
  mesh.texture.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) mesh.texture.push_back({pairs[t[0]], pairs[t[1]], pairs[t[2]]});
  const auto same = [](const auto& values, std::size_t a, std::size_t b) {
    return values.empty() || values[a] == values[b];
  };
  std::vector<std::uint32_t> joined(mesh.positions.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < joined.size(); ++v) {
    const bool copy = v > 0 && mesh.positions[v] == mesh.positions[v - 1] && same(mesh.normals, v, v - 1) &&
                      same(mesh.colors, v, v - 1) && pairs[v] != pairs[v - 1];
    joined[v] = copy ? count - 1 : count++;
  }
  const auto gather = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t v = 0; v < joined.size(); ++v) values[joined[v]] = values[v];
    values.resize(count);
  };
  gather(mesh.normals);
  gather(mesh.colors);
  gather(mesh.positions);
  for (auto& t : mesh.triangles)
    for (std::uint32_t& v : t) v = joined[v];
}

}  // namespace tafoni::io::impl
