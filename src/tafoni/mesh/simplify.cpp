// Simplifies in rounds of patches whose grid is shifted, so that the seams of one round lie inside the
// patches of the next. A patch that breaks the surface is done again in smaller parts, then with less error,
// and at last left as it was.

#include "tafoni/mesh/simplify.h"

#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/mesh/impl/patches.h"

namespace tafoni::mesh {
namespace {

using impl::Patch;
using inner::Triangle;

/// A patch is large against its border, which stays as it is, and small enough that threads share the work.
constexpr std::size_t patch_triangles = 20000;
/// A patch below this that breaks the surface is not cut any further, or borders would be most of it.
constexpr std::size_t least_patch = 1000;
/// A patch that has lost all but a part in so many is flat.
constexpr std::size_t flat_reduction = 12;
/// A sixteenth of the error leaves little to gain: the patch stays as it was.
constexpr int most_halvings = 4;

std::vector<Triangle> join_results(const std::vector<Patch>& patches) {
  std::size_t total = 0;
  for (const Patch& p : patches) total += p.result.size();
  std::vector<Triangle> out;
  out.reserve(total);
  for (const Patch& p : patches) out.insert(out.end(), p.result.begin(), p.result.end());
  return out;
}

void collapse_all(const impl::Surface& surface, const impl::Ownership& ownership, std::vector<Patch>& patches,
                  double error, Progress& progress) {
  std::vector<std::size_t> unfinished;
  for (std::size_t p = 0; p < patches.size(); ++p)
    if (!patches[p].done) unfinished.push_back(p);
  parallel_for(
      std::ssize(unfinished),
      [&](std::int64_t at) {
        Patch& patch = patches[unfinished[at]];
        impl::collapse(surface, ownership, patch, std::ldexp(error, -patch.halvings));
      },
      progress);
}

/// What to do instead of a collapse that broke the surface: the same in smaller parts, or apart from its
/// neighbours, then with less error, and in the end nothing. Where hardly more than the border is left, which
/// on flat ground the neighbour may join in the same way, smaller parts would only have more border.
void try_again(std::span<const Vec3f> positions, impl::Ownership& ownership, Patch& patch,
               std::vector<Patch>& next) {
  patch.done = patch.broken = false;
  const bool flat = patch.result.size() < patch.given.size() / flat_reduction;
  if (!patch.parted && (flat || patch.given.size() <= least_patch)) {
    patch.parted = true;
    next.push_back(std::move(patch));
    return;
  }
  if (patch.given.size() > least_patch) {
    auto parts = impl::cut(positions, patch.given, patch.given.size() / 4, 0.25);
    if (parts.size() > 1) {
      for (Patch& part : parts) {
        ownership.take(part, patch.id);
        next.push_back(std::move(part));
      }
      return;
    }
  }
  if (++patch.halvings > most_halvings) {
    patch.result = patch.given;
    patch.done = patch.rejected = true;
  }
  next.push_back(std::move(patch));
}

/// Edge collapse can pinch the surface, within a patch or between two that share border vertices. Returns
/// whether there are such patches, and readies them to be done again; the given surface is sound, so this
/// ends.
bool mend(std::span<const Vec3f> positions, impl::Ownership& ownership, std::vector<Patch>& patches) {
  const std::vector<bool> broken = impl::broken_shared_vertices(positions, ownership, patches);
  std::vector<Patch> next;
  bool again = false;
  for (Patch& patch : patches) {
    bool bad = patch.broken;
    for (const Triangle& t : patch.result) bad = bad || broken[t[0]] || broken[t[1]] || broken[t[2]];
    if (!bad || patch.rejected) {
      next.push_back(std::move(patch));
      continue;
    }
    again = true;
    try_again(positions, ownership, patch, next);
  }
  patches = std::move(next);
  return again;
}

std::vector<Triangle> simplify_round(const impl::Surface& surface, std::span<const Triangle> triangles,
                                     double error, double shift, Progress& progress, SimplifyStats& stats) {
  const std::span<const Vec3f> positions = surface.positions;
  std::vector<Patch> patches = impl::cut(positions, triangles, patch_triangles, shift);
  impl::Ownership ownership(positions.size());
  for (Patch& patch : patches) ownership.take(patch);
  progress.begin("simplify", patches.size(), "patches");
  do collapse_all(surface, ownership, patches, error, progress);
  while (mend(positions, ownership, patches));
  progress.end();
  stats.patches += patches.size();
  for (const Patch& patch : patches) stats.patches_rejected += patch.rejected;
  return join_results(patches);
}

/// Keeps the vertices in use, in order.
Mesh drop_unused_vertices(const Mesh& mesh, std::vector<Triangle> triangles) {
  std::vector<std::uint32_t> index(mesh.positions.size(), 0);
  for (const Triangle& t : triangles)
    for (auto v : t) index[v] = 1;
  Mesh out;
  out.origin = mesh.origin;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (!index[v]) continue;
    index[v] = count++;
    out.positions.push_back(mesh.positions[v]);
    if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
    if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
  }
  for (Triangle& t : triangles)
    for (auto& v : t) v = index[v];
  out.triangles = std::move(triangles);
  return out;
}

}  // namespace

Mesh simplify(const Mesh& mesh, const SimplifySettings& settings, Progress& progress, SimplifyStats* stats) {
  if (!(settings.error >= 0) || !std::isfinite(settings.error))
    fail(ErrorKind::usage, "an error of {} m cannot be used to simplify: give 0 or more", settings.error);
  SimplifyStats sums;
  sums.triangles_before = mesh.triangles.size();
  std::vector<Triangle> triangles = mesh.triangles;
  const std::vector<bool> seam =
      settings.seams ? inner::on_border(mesh.triangles, mesh.positions.size()) : std::vector<bool>{};
  // The second round works on the first's seams; each may use half of the error.
  if (settings.error > 0)
    for (double shift : {0.0, 0.5})
      triangles =
          simplify_round({mesh.positions, seam}, triangles, settings.error / 2, shift, progress, sums);
  Mesh out = drop_unused_vertices(mesh, std::move(triangles));
  if (settings.normals) {
    out.normals.resize(out.positions.size());
    settings.normals(out.positions, out.normals);
  }
  sums.triangles_after = out.triangles.size();
  if (stats) *stats = sums;
  return out;
}

}  // namespace tafoni::mesh
