#pragma once
// Edits of one run of samples by a ball, compiled for every instruction set: the tool that is used most.

#include "tafoni/volume/impl/tool_shape.h"

namespace tafoni::volume::impl {

/// Samples along x, n at most a chunk's side: the i-th lies at (origin + spacing * (first + i), y, z).
struct SampleRun {
  double origin, spacing, y, z;
  int first, n;
};

/// min(value, -d) or, to add, max(value, d) wherever d > -amplitude, d the ball's distance, at most
/// amplitude.
void combine(const Sphere& ball, Edit edit, double amplitude, const SampleRun& run, float* values);

}  // namespace tafoni::volume::impl
