// Cuts a mesh into patches by the columns of a horizontal grid, collapses the edges of each by meshoptimizer
// in numbers of its own, and finds the vertices at which a collapse pinched the surface.

#include "tafoni/mesh/impl/patches.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include <meshoptimizer.h>

#include "tafoni/math/counts.h"
#include "tafoni/mesh/inner/size32.h"

namespace tafoni::mesh::impl {

namespace {

/// Numbers from 0 in the order of first appearance, by open addressing.
class LocalNumbers {
 public:
  explicit LocalNumbers(std::size_t most) : slots_(std::bit_ceil(2 * most + 2), Slot{}) {}

  std::uint32_t operator()(std::uint32_t global) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = (global * 0x9e3779b1u) & mask;
    while (slots_[at].global != empty && slots_[at].global != global) at = (at + 1) & mask;
    if (slots_[at].global == empty) {
      slots_[at] = {global, inner::size32(globals_)};
      globals_.push_back(global);
    }
    return slots_[at].local;
  }
  const std::vector<std::uint32_t>& globals() const { return globals_; }

 private:
  static constexpr std::uint32_t empty = 0xffffffff;
  struct Slot {
    std::uint32_t global = empty, local = 0;
  };
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> globals_;
};

/// Triangles by their own numbers for the vertices they use.
struct LocalMesh {
  std::vector<std::uint32_t> globals;
  std::vector<Vec3f> positions;  ///< relative to the first
  std::vector<Triangle> triangles;
};

LocalMesh local_mesh(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  LocalMesh out;
  LocalNumbers number(triangles.size() + 16);
  out.triangles.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const std::uint32_t a = number(t[0]), b = number(t[1]);
    out.triangles.push_back({a, b, number(t[2])});
  }
  out.globals = number.globals();
  out.positions.reserve(out.globals.size());
  for (std::uint32_t v : out.globals) out.positions.push_back(positions[v] - positions[out.globals[0]]);
  return out;
}

/// Index of each triangle that has the same three vertices as another, in pairs.
std::vector<std::size_t> repeated_triangles(std::span<const Triangle> triangles) {
  std::vector<std::pair<Triangle, std::size_t>> keys;
  keys.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    keys.emplace_back(triangles[t], t);
    std::sort(keys.back().first.begin(), keys.back().first.end());
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> out;
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (keys[i].first == keys[i - 1].first) out.insert(out.end(), {keys[i - 1].second, keys[i].second});
  return out;
}

/// Whether a triangle runs the other way round than its vertices in order do.
bool runs_back(const Triangle& t) {
  return (t[0] < t[1]) + (t[1] < t[2]) + (t[2] < t[0]) == 1;
}

/// A small closed piece collapses to two triangles back to back, which enclose nothing: they go. Of three, as
/// a piece that has collapsed onto another triangle makes them, one stays, or there would be a hole.
void remove_pillows(std::vector<Triangle>& triangles) {
  const Triangle gone{};
  std::vector<std::size_t> repeated = repeated_triangles(triangles);
  const auto key = [&](std::size_t t) {
    Triangle sorted = triangles[t];
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  std::sort(repeated.begin(), repeated.end());
  repeated.erase(std::unique(repeated.begin(), repeated.end()), repeated.end());
  std::stable_sort(repeated.begin(), repeated.end(),
                   [&](std::size_t s, std::size_t t) { return key(s) < key(t); });
  for (std::size_t begin = 0, end = 0; begin < repeated.size(); begin = end) {
    std::vector<std::size_t> ways[2];
    const Triangle vertices = key(repeated[begin]);
    for (; end < repeated.size() && key(repeated[end]) == vertices; ++end)
      ways[runs_back(triangles[repeated[end]])].push_back(repeated[end]);
    for (std::size_t i = 0; i < std::min(ways[0].size(), ways[1].size()); ++i)
      triangles[ways[0][i]] = triangles[ways[1][i]] = gone;
  }
  std::erase(triangles, gone);
}

std::vector<Triangle> collapsed(const LocalMesh& local, std::span<const Triangle> triangles, double error) {
  const float scale = meshopt_simplifyScale(&local.positions[0].x, local.positions.size(), sizeof(Vec3f));
  std::vector<Triangle> out(triangles.size());
  const std::size_t left =
      scale > 0 && !triangles.empty()
          ? meshopt_simplify(&out[0][0], &triangles[0][0], 3 * triangles.size(), &local.positions[0].x,
                             local.positions.size(), sizeof(Vec3f), 0, static_cast<float>(error) / scale,
                             meshopt_SimplifyLockBorder, nullptr)
          : 0;
  out.resize(left / 3);
  flip_flat_triangles(local.positions, out);
  remove_pillows(out);
  return out;
}

/// The edges and triangles between vertices of seams.
struct SeamChords {
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<Triangle> triangles;

  SeamChords(std::span<const Triangle> all, const std::vector<bool>& seam) {
    for (Triangle t : all) {
      std::sort(t.begin(), t.end());
      for (const auto& [a, b] : {std::array{t[0], t[1]}, std::array{t[0], t[2]}, std::array{t[1], t[2]}})
        if (seam[a] && seam[b]) edges.push_back({a, b});
      if (seam[t[0]] && seam[t[1]] && seam[t[2]]) triangles.push_back(t);
    }
    std::sort(edges.begin(), edges.end());
    std::sort(triangles.begin(), triangles.end());
  }
};

/// Marks a vertex of each of `found`, the one that most of them have, so that few are marked. False if every
/// vertex of one was marked before.
bool keep_some(const std::vector<std::vector<std::uint32_t>>& found, std::vector<bool>& kept) {
  std::vector<std::uint32_t> uses(kept.size(), 0);
  for (const auto& vertices : found)
    for (const std::uint32_t v : vertices) ++uses[v];
  const std::vector<bool> before = kept;
  for (const auto& vertices : found) {
    std::optional<std::uint32_t> most;
    bool done = false;
    for (const std::uint32_t v : vertices) {
      done = done || (kept[v] && !before[v]);
      if (!before[v] && (!most || uses[v] > uses[*most])) most = v;
    }
    if (!most) return false;
    if (!done) kept[*most] = true;
  }
  return true;
}

/// Collapses again, with the triangles about some vertices as they were given, until no edge and no triangle
/// between vertices of seams is new. False if that cannot be.
bool part_seams(const LocalMesh& local, const std::vector<bool>& on_seam, double error,
                std::vector<Triangle>& out) {
  std::vector<bool> kept(local.positions.size(), false);
  const SeamChords given(local.triangles, on_seam);
  for (;;) {
    const SeamChords made(out, on_seam);
    std::vector<std::vector<std::uint32_t>> found;
    for (const auto& edge : made.edges)
      if (!std::binary_search(given.edges.begin(), given.edges.end(), edge))
        found.push_back({edge[0], edge[1]});
    for (const Triangle& t : made.triangles)
      if (!std::binary_search(given.triangles.begin(), given.triangles.end(), t))
        found.push_back({t[0], t[1], t[2]});
    if (found.empty()) return true;
    if (!keep_some(found, kept)) return false;
    std::vector<Triangle> free, still;
    for (const Triangle& t : local.triangles)
      (kept[t[0]] || kept[t[1]] || kept[t[2]] ? still : free).push_back(t);
    out = collapsed(local, free, error);
    out.insert(out.end(), still.begin(), still.end());
  }
}

}  // namespace

void Ownership::take(Patch& patch, std::uint32_t parent) {
  patch.id = next_++;
  for (const Triangle& t : patch.given)
    for (auto v : t) {
      if (owners_[v] == none || owners_[v] == parent)
        owners_[v] = patch.id;
      else if (owners_[v] != patch.id)
        shared_[v] = true;
    }
}

std::vector<Patch> cut(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                       std::size_t wanted, double shift) {
  if (triangles.empty()) return {};
  if (triangles.size() <= wanted) {
    std::vector<Patch> all(1);
    all[0].given.assign(triangles.begin(), triangles.end());
    return all;
  }
  // A corner places a triangle as well as its middle does.
  Box3f box;
  for (const Triangle& t : triangles) box.expand(positions[t[0]]);
  const double count = std::max(1.0, ratio(triangles.size(), wanted));
  const double width = box.size().x, depth = box.size().y;
  const double side = std::max({std::sqrt(width * depth / count), width / 1000, depth / 1000, 1e-6});
  const auto columns = static_cast<std::size_t>(width / side + 2),
             rows = static_cast<std::size_t>(depth / side + 2);
  std::vector<Patch> patches(columns * rows);
  for (const Triangle& t : triangles) {
    const Vec3f p = positions[t[0]];
    const auto column = static_cast<std::size_t>((p.x - box.lo.x) / side + shift);
    const auto row = static_cast<std::size_t>((p.y - box.lo.y) / side + shift);
    patches[std::min(row, rows - 1) * columns + std::min(column, columns - 1)].given.push_back(t);
  }
  std::erase_if(patches, [](const Patch& p) { return p.given.empty(); });
  return patches;
}

void collapse(const Surface& surface, const Ownership& ownership, Patch& patch, double error) {
  const LocalMesh local = local_mesh(surface.positions, patch.given);
  std::vector<Triangle> out = collapsed(local, local.triangles, error);
  patch.broken = false;
  if (!surface.seam.empty() || patch.parted) {
    std::vector<bool> on_seam(local.positions.size());
    for (std::size_t v = 0; v < on_seam.size(); ++v) {
      const std::uint32_t global = local.globals[v];
      on_seam[v] =
          (!surface.seam.empty() && surface.seam[global]) || (patch.parted && ownership.shared(global));
    }
    patch.broken = !part_seams(local, on_seam, error, out);
  }
  const std::vector<bool> broken = broken_vertices(local.positions, out);
  for (std::size_t v = 0; v < broken.size(); ++v)
    if (broken[v] && !ownership.shared(local.globals[v])) patch.broken = true;
  for (Triangle& t : out)
    for (auto& v : t) v = local.globals[v];
  patch.result = std::move(out);
  patch.done = true;
}

std::vector<bool> broken_vertices(std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  std::vector<bool> broken(positions.size(), false);
  for (const Triangle& t : triangles) {
    const Vec3d a = to_double(positions[t[0]]), b = to_double(positions[t[1]]),
                c = to_double(positions[t[2]]);
    if (cross(b - a, c - a) == Vec3d{})
      for (auto v : t) broken[v] = true;
  }
  for_each_edge(triangles, positions.size(),
                [&](std::uint32_t a, std::uint32_t b, std::uint32_t forward, std::uint32_t backward) {
                  if (forward > 1 || backward > 1) broken[a] = broken[b] = true;
                });
  // Two triangles back to back share three clean edges.
  for (std::size_t t : repeated_triangles(triangles))
    for (auto v : triangles[t]) broken[v] = true;
  const Incidence around = incidence(triangles, positions.size());
  FanCounter fans;
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (!around.at(v).empty() && fans.count(triangles, around.at(v), v) > 1) broken[v] = true;
  return broken;
}

std::vector<bool> broken_shared_vertices(std::span<const Vec3f> positions, const Ownership& ownership,
                                         std::span<const Patch> patches) {
  std::vector<Triangle> around;
  for (const Patch& patch : patches)
    for (const Triangle& t : patch.result)
      if (ownership.shared(t[0]) || ownership.shared(t[1]) || ownership.shared(t[2])) around.push_back(t);
  const LocalMesh local = local_mesh(positions, around);
  const std::vector<bool> broken = broken_vertices(local.positions, local.triangles);
  std::vector<bool> out(positions.size(), false);
  for (std::size_t v = 0; v < broken.size(); ++v)
    if (broken[v] && ownership.shared(local.globals[v])) out[local.globals[v]] = true;
  return out;
}

}  // namespace tafoni::mesh::impl
