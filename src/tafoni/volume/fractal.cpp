// Fractal volumes: a coarse lattice of values is subdivided level by level, each time with less noise
// [Ju01 §2]. All levels but the last are kept; samples of the last are made when they are asked for, box
// by box.

#include "tafoni/volume/fractal.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/math/whole.h"
#include "tafoni/volume/impl/subdivision.h"

namespace tafoni::volume {
namespace {

constexpr int samples_side = ScalarGrid::chunk_samples;

void check(const FractalSettings& s) {
  if (s.cells.x < 1 || s.cells.y < 1 || s.cells.z < 1)
    fail(ErrorKind::usage, "a fractal's coarse lattice must have at least one cell a side, not {} x {} x {}",
         s.cells.x, s.cells.y, s.cells.z);
  if (s.levels < 1 || s.levels > 20)
    fail(ErrorKind::usage, "a fractal must be subdivided 1 to 20 times, not {}", s.levels);
  const double samples = (std::ldexp(s.cells.x, s.levels) + 1) * (std::ldexp(s.cells.y, s.levels) + 1) *
                         (std::ldexp(s.cells.z, s.levels) + 1);
  if (!(samples <= 0x1p40))
    fail(ErrorKind::usage, "a fractal of {:g} samples is too large; take fewer levels", samples);
  const std::size_t wanted = std::int64_t{s.cells.x + 1} * (s.cells.y + 1) * (s.cells.z + 1);
  if (s.coarse.size() != wanted)
    fail(ErrorKind::usage, "a coarse lattice of {} x {} x {} cells needs {} values, not {}", s.cells.x,
         s.cells.y, s.cells.z, wanted, s.coarse.size());
  if (!std::all_of(s.coarse.begin(), s.coarse.end(), [](float v) { return std::isfinite(v); }) ||
      !std::all_of(s.noise.begin(), s.noise.end(), [](double v) { return std::isfinite(v) && v >= 0; }))
    fail(ErrorKind::usage, "a fractal's values must be finite, and its noise 0 or more");
  if (!(s.spacing > 0) || !std::isfinite(s.spacing) || !(s.limit > 0))
    fail(ErrorKind::usage, "a fractal's spacing and limit must be positive lengths in metres");
  for (const Pin& pin : s.pins)
    if (pin.level < 0 || pin.level >= s.levels || !std::isfinite(pin.value) || !(pin.radius >= 0))
      fail(ErrorKind::usage, "a pin's level must be from 0 to {}, its value finite and its radius 0 or more",
           s.levels - 1);
}

float noise_of(const FractalSettings& s, int level) {
  return level < std::ssize(s.noise) ? static_cast<float>(s.noise[level]) : 0.0f;
}

std::uint64_t key_of(const FractalSettings& s, int level) {
  return hash_combine(s.seed, level);
}

impl::Subdivision last_step(const FractalSettings& s, const std::vector<float>& values, Vec3i size) {
  return {{values.data(), size},
          key_of(s, s.levels - 1),
          noise_of(s, s.levels - 1),
          static_cast<float>(std::min(s.limit, 1e30))};
}

/// The boxes of at most 32 x 32 rows that tile a box, whole rows each.
std::vector<SampleBox> bars(const SampleBox& box) {
  std::vector<SampleBox> out;
  for (int z = box.lo.z; z <= box.hi.z; z += samples_side)
    for (int y = box.lo.y; y <= box.hi.y; y += samples_side)
      out.push_back(
          {{box.lo.x, y, z},
           {box.hi.x, std::min(y + samples_side - 1, box.hi.y), std::min(z + samples_side - 1, box.hi.z)}});
  return out;
}

/// The limit that all samples of a chunk are at.
std::optional<float> at_limit(const SampleBox& part, const float* samples, float limit) {
  const float first = samples[0];
  if (std::abs(first) != limit) return {};
  const Vec3i n = part.size();
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y) {
      const float* row = samples + (z * samples_side + y) * samples_side;
      if (!std::all_of(row, row + n.x, [&](float v) { return v == first; })) return {};
    }
  return first;
}

}  // namespace

Fractal::Fractal(FractalSettings settings, Progress& progress) : settings_(std::move(settings)) {
  check(settings_);
  const FractalSettings& s = settings_;
  last_ = {{s.cells.x + 1, s.cells.y + 1, s.cells.z + 1}, s.coarse};
  pin(0, last_);
  for (int level = 0; level + 1 < s.levels; ++level) {
    Level fine;
    fine.size = {2 * last_.size.x - 1, 2 * last_.size.y - 1, 2 * last_.size.z - 1};
    const std::size_t row = fine.size.x, plane = row * fine.size.y;
    fine.values.resize(plane * fine.size.z);
    const impl::Subdivision step{
        {last_.values.data(), last_.size}, key_of(s, level), noise_of(s, level), 1e30f};
    const auto parts = bars({{0, 0, 0}, {fine.size.x - 1, fine.size.y - 1, fine.size.z - 1}});
    parallel_blocks(std::ssize(parts), 1, [&](std::int64_t begin, std::int64_t) {
      progress.check();
      const SampleBox& box = parts[begin];
      impl::subdivide(step, box, fine.values.data() + box.lo.z * plane + box.lo.y * row, row, plane);
    });
    last_ = std::move(fine);
    pin(level + 1, last_);
  }
}

void Fractal::pin(int level, Level& lattice) const {
  const Vec3i n = lattice.size;
  const auto value = [&](int x, int y, int z) -> float& {
    return lattice.values[(std::int64_t{z} * n.y + y) * n.x + x];
  };
  const auto clamped = [](double v, int size) { return round_to(std::clamp<double>(v, 0.0, size - 1)); };
  /// The pin's place on a level, in its spacings.
  const auto place = [&](const Pin& p, int of) {
    return (p.position - settings_.origin) * std::ldexp(1 / settings_.spacing, of - settings_.levels);
  };
  for (const Pin& p : settings_.pins) {
    if (p.level != level || !(p.radius > 0)) continue;
    const Vec3d at = place(p, level);
    const Vec3i own{clamped(at.x, n.x), clamped(at.y, n.y), clamped(at.z, n.z)};
    const double r = std::ldexp(p.radius / settings_.spacing, level - settings_.levels);
    for (int z = clamped(own.z - r, n.z); z <= clamped(own.z + r, n.z); ++z)
      for (int y = clamped(own.y - r, n.y); y <= clamped(own.y + r, n.y); ++y)
        for (int x = clamped(own.x - r, n.x); x <= clamped(own.x + r, n.x); ++x) {
          const double dx = x - own.x, dy = y - own.y, dz = z - own.z;
          const double left = 1 - (dx * dx + dy * dy + dz * dz) / (r * r);
          if (left <= 0) continue;
          const double was = value(x, y, z);
          value(x, y, z) = static_cast<float>(was + left * left * (p.value - was));
        }
  }
  // Where one pin draws at another's sample, the other's value stays.
  for (const Pin& p : settings_.pins) {
    if (p.level > level) continue;
    const Vec3d at = place(p, p.level);
    const int finer = level - p.level;
    const auto own = [&](double v, int size) { return clamped(v, ((size - 1) >> finer) + 1) << finer; };
    value(own(at.x, n.x), own(at.y, n.y), own(at.z, n.z)) = static_cast<float>(p.value);
  }
}

void Fractal::read(const SampleBox& box, float* out) const {
  const std::size_t row = box.size().x;
  impl::subdivide(last_step(settings_, last_.values, last_.size), box, out, row, row * box.size().y);
}

Interval Fractal::range(const SampleBox& box) const {
  return impl::subdivision_range(last_step(settings_, last_.values, last_.size), box);
}

ScalarGrid Fractal::grid(const SampleBox& box, Precision precision, Progress& progress) const {
  const FractalSettings& s = settings_;
  const Vec3i lo = box.lo;
  GridFrame frame{s.origin + Vec3d{s.spacing * lo.x, s.spacing * lo.y, s.spacing * lo.z}, s.spacing,
                  box.size()};
  ScalarGrid made(frame, 0, precision);
  const impl::Subdivision step = last_step(s, last_.values, last_.size);
  const Vec3i chunks = made.chunks();
  progress.begin("subdividing", std::int64_t{chunks.x} * chunks.y * chunks.z, "chunks");
  made.generate(
      [&](const SampleBox& part, float* out) -> std::optional<float> {
        const SampleBox own{part.lo + lo, part.hi + lo};
        if (s.limit < 1e30) {
          const Interval range = impl::subdivision_range(step, own);
          if (range.lo >= step.limit) return step.limit;
          if (range.hi <= -step.limit) return -step.limit;
        }
        impl::subdivide(step, own, out, samples_side, samples_side * samples_side);
        return at_limit(part, out, step.limit);
      },
      progress);
  progress.end();
  return made;
}

ScalarGrid Fractal::grid(Precision precision, Progress& progress) const {
  const Vec3i n = settings_.size();
  return grid({{0, 0, 0}, {n.x - 1, n.y - 1, n.z - 1}}, precision, progress);
}

std::vector<double> decaying_noise(double scale, double decay, int levels, int smooth) {
  std::vector<double> out(std::max(levels, 0), 0.0);
  for (int level = 0; level < levels - smooth; ++level) out[level] = scale * std::pow(decay, level);
  return out;
}

}  // namespace tafoni::volume
