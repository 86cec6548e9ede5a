// Disjoint sets over the parts of pieces. A piece is joined with those beside it as it comes, by the lists of
// vertices on their common face and by a table of vertices along chunk edges.

#include "tafoni/surface/impl/connect.h"

#include <algorithm>
#include <cmath>

#include "tafoni/mesh/inner/size32.h"

namespace tafoni::surface::impl {

std::uint32_t Connectivity::root(std::uint32_t part) {
  while (parents_[part] != part) part = parents_[part] = parents_[parents_[part]];
  return part;
}

void Connectivity::join(std::uint32_t a, std::uint32_t b) {
  a = root(a), b = root(b);
  if (a < b)
    parents_[b] = a;
  else
    parents_[a] = b;
}

void Connectivity::add(const Piece& piece) {
  const auto first = mesh::inner::size32(parts_);
  first_part_.emplace(piece.chunk, first);
  for (const Part& part : piece.parts) {
    parents_.push_back(mesh::inner::size32(parts_));
    parts_.push_back(part);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto& low = piece.faces[2 * axis];
    Vec3i neighbour = piece.chunk;
    (axis == 0 ? neighbour.x : axis == 1 ? neighbour.y : neighbour.z) -= 1;
    const auto found = high_faces_[axis].find(neighbour);
    if (found != high_faces_[axis].end()) {
      const Face& other = found->second;
      std::size_t at = 0;
      for (const BorderVertex& v : low) {
        while (at < other.places.size() && other.places[at] < v.place) ++at;
        if (at < other.places.size() && other.places[at] == v.place)
          join(first + piece.part_of(v.vertex), other.parts[at]);
      }
      high_faces_[axis].erase(found);
    }
    const auto& high = piece.faces[2 * axis + 1];
    if (high.empty()) continue;
    Face face;
    for (const BorderVertex& v : high) {
      face.places.push_back(v.place);
      face.parts.push_back(first + piece.part_of(v.vertex));
    }
    high_faces_[axis].emplace(piece.chunk, std::move(face));
  }
  for (const CornerVertex& v : piece.corners) {
    const std::uint32_t part = first + piece.part_of(v.vertex);
    const auto [at, fresh] = corners_.emplace(v.edge, part);
    if (!fresh) join(part, at->second);
  }
}

Connectivity::Result Connectivity::decide(double least) {
  Result result;
  std::vector<Part> sums(parts_.size());
  for (std::uint32_t p = 0; p < parts_.size(); ++p) {
    Part& sum = sums[root(p)];
    sum.volume += parts_[p].volume;
    sum.triangles += parts_[p].triangles;
    sum.open = sum.open || parts_[p].open;
  }
  for (std::uint32_t p = 0; p < parts_.size(); ++p) {
    const Part& sum = sums[root(p)];
    const bool small = !sum.open && std::abs(sum.volume) < least;
    if (small) removed_.insert(p);
    if (root(p) != p) continue;
    ++result.components;
    if (small) ++(sum.volume >= 0 ? result.fragments : result.bubbles);
  }
  return result;
}

bool Connectivity::removed(Vec3i chunk, std::uint32_t part) const {
  return !removed_.empty() && removed_.contains(first_part_.at(chunk) + part);
}

}  // namespace tafoni::surface::impl
