#pragma once
// Poisson-sphere samples on an implicit surface, whatever its shape: flats, faces, overhangs, cave walls.

#include <cstdint>
#include <functional>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms {

struct SurfaceSample {
  Vec3d position;  ///< local, on f = 0
  Vec3f normal;    ///< unit, out of the rock
};

struct SurfaceSampling {
  double spacing = 2;  ///< metres: no two samples are nearer, no accepted surface is twice as far from one
  Box3d box;           ///< local, finite; only surface in it is sampled
  std::uint64_t seed = 0;
  /// Refuses whole pieces of space before anything is projected, from 64 cells of half the spacing down to
  /// one; null refuses none. It is given a piece's centre and how far from it a sample may lie, is false only
  /// where no sample would be accepted, and is called from many threads.
  std::function<bool(Vec3d center, double around)> maybe;
  /// Whether a place may hold a sample; null lets all. It is asked of every candidate as a lattice of half
  /// the spacing shows the surface, and of samples again, from many threads.
  std::function<bool(const SurfaceSample&)> accept;
};

/// Makes blue noise on f = 0 [Paris19 §6.1]: jittered candidates in every lattice cell that the surface cuts
/// are projected along the gradient and thinned by dart throwing in an order that depends on the seed alone.
/// They come in random order, so that every prefix is spread over the whole too. Throws Error{usage} for a
/// spacing so small that the box has more than 2^22 lattice columns of 64 x 64 cells.
std::vector<SurfaceSample> sample_surface(const field::CompiledField& field, const SurfaceSampling& settings,
                                          Progress& progress = silent());

}  // namespace tafoni::landforms
