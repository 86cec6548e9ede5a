// Chooses where water enters the rock. A sparse sample of the whole surface, wherever it is, is sorted into
// gentle ground and faces, each ordered by the resistance of the rock behind it; closed depressions of the
// raster come before gentle ground. From each list the first that lie apart are taken.

#include "tafoni/landforms/karst/entrances.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/landforms/site/table_rows.h"
#include "tafoni/math/angle.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::impl {
namespace {

enum class EntrancesStream : std::uint64_t { surface = 0xface };

// Chosen by eye.
constexpr double apart = 3;             // spacings between entrances: each then has room for a network
constexpr double sink_pixels = 4;       // area of the least depression: smaller ones are noise of the raster
constexpr double samples_across = 150;  // of the surface along the longer side: enough to choose from
constexpr float least_up = -0.3f;       // normal's z of what is sampled: roofs of overhangs take no water
constexpr float gentle_up = 0.93f;      // normal's z of gentle ground: slopes below 22 degrees
constexpr double under_ground = 3;      // radii below gentle ground at which its rock is judged
constexpr double behind_face = 2;       // radii behind a face at which its rock is judged
constexpr double fin = 3;               // radii to either side in which a face has rock: a fin has not
constexpr double inward_fall = -0.1;    // of the way in from a face, which runs almost level
constexpr double steepest_fall = -0.2;  // of the field upward, so that steps to the surface stay short

class Chooser {
 public:
  Chooser(const field::CompiledField& field, const Ground& ground, const CaveSize& size, double lowest,
          const EntranceSettings& settings, Progress& progress)
      : field_(field), ground_(ground), size_(size), lowest_(lowest), s_(settings), progress_(progress) {}

  std::vector<Vec3d> seeds() {
    std::vector<Vec3d> all;
    for (Vec3d p : ground_.site().points) {
      if (field_.value(p) < 0) p = rock_below(p);
      if (ground_.usable(p)) all.push_back(p);
    }
    SpatialHash taken(2 * apart * size_.spacing);
    for (Vec3d p : all) taken.insert(p);
    if (s_.sinks > 0 || s_.faces > 0) survey();
    if (s_.sinks > 0) add_apart(sinks(), s_.sinks, taken, all);
    if (s_.faces > 0) add_apart(faces(), s_.faces, taken, all);
    return all;
  }

  std::vector<Vec3d> springs() const {
    if (s_.springs.size() % 3 != 0)
      fail(ErrorKind::usage,
           "karst: springs needs x, y and z for each spring, so a multiple of three numbers");
    std::vector<Vec3d> all;
    for (std::size_t i = 0; i + 2 < s_.springs.size(); i += 3) {
      const Vec3d world{s_.springs[i], s_.springs[i + 1], s_.springs[i + 2]};
      const Vec3d p = on_surface(world - ground_.site().origin);
      if (ground_.usable(p)) all.push_back(p);
    }
    warn_of_left_out("karst: springs", std::ssize(all), std::ssize(s_.springs) / 3, progress_);
    return all;
  }

 private:
  /// The first rock under a place in the air; the place itself when there is none.
  Vec3d rock_below(Vec3d p) const {
    for (Vec3d q = p; q.z > ground_.box().lo.z; q.z -= 0.5 * size_.radius)
      if (field_.value(q) > 0) return on_surface(q);
    return p;
  }

  void add_apart(const std::vector<Vec3d>& wanted, std::int64_t most, SpatialHash& taken,
                 std::vector<Vec3d>& all) const {
    std::int64_t added = 0;
    for (Vec3d p : wanted) {
      if (added == most) return;
      if (taken.any_near(p, apart * size_.spacing)) continue;
      taken.insert(p);
      all.push_back(p);
      ++added;
    }
  }

  /// Gentle ground and faces of the whole surface, wherever it is: a sparse choice is enough.
  void survey() {
    const Vec3d extent = ground_.box().size();
    SurfaceSampling sampling;
    sampling.spacing = std::clamp(std::max(extent.x, extent.y) / samples_across, 0.5 * size_.spacing,
                                  std::max(1.5 * size_.spacing, 1e-3));
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, EntrancesStream::surface);
    sampling.accept = [&](const SurfaceSample& at) {
      return at.normal.z > least_up && high(at.position) && ground_.usable(at.position, size_.spacing);
    };
    surface_ = sample_surface(field_, sampling, progress_);
  }

  /// Closed depressions, the largest first, then gentle ground.
  std::vector<Vec3d> sinks() const {
    const raster::Raster& heights = *ground_.site().heights;
    const double pixel = ground_.pixel();
    auto found = terrain::sinks(heights, {s_.sink_depth, sink_pixels * pixel * pixel}, progress_);
    std::stable_sort(found.begin(), found.end(),
                     [](const terrain::Sink& a, const terrain::Sink& b) { return a.volume > b.volume; });
    std::vector<Vec3d> points;
    for (const terrain::Sink& sink : found) {
      const Vec2d at = heights.placement.center(sink.col, sink.row);
      const Vec3d p{at.x, at.y, sink.elevation};
      if (high(p) && ground_.usable(p, size_.spacing)) points.push_back(on_surface(p));
    }
    const std::vector<Vec3d> gentle = gentle_ground();
    points.insert(points.end(), gentle.begin(), gentle.end());
    return points;
  }

  std::vector<Vec3d> gentle_ground() const {
    std::vector<Candidate> places;
    for (const SurfaceSample& at : surface_)
      if (at.normal.z > gentle_up && deep(at.position)) {
        const Vec3d below = at.position - Vec3d{0, 0, under_ground * size_.radius};
        places.push_back({ground_.resistance(below), at.position});
      }
    return softest_first(std::move(places));
  }

  std::vector<Vec3d> faces() const {
    const auto steep = static_cast<float>(std::cos(s_.face_slope * degree));
    std::vector<Candidate> places;
    for (const SurfaceSample& at : surface_)
      if (at.normal.z < steep && thick(at)) {
        const Vec3d behind = at.position - to_double(at.normal) * (behind_face * size_.radius);
        places.push_back({ground_.resistance(behind), at.position});
      }
    return softest_first(std::move(places));
  }

  /// Whether there is room below to descend into.
  bool high(Vec3d p) const { return p.z > lowest_; }

  /// Whether there is rock for a shaft, not a thin roof.
  bool deep(Vec3d p) const {
    for (double t : {0.5, 1.0, 1.5})
      if (field_.value(p - Vec3d{0, 0, t * size_.spacing}) <= 0) return false;
    return true;
  }

  /// Whether there is rock enough behind a face for a cave, not a fin or a pillar.
  bool thick(const SurfaceSample& at) const {
    const Vec3d outward = to_double(at.normal);
    const Vec3d inward = normalized(Vec3d{-outward.x, -outward.y, inward_fall});
    const Vec3d aside = Vec3d{-inward.y, inward.x, 0} * (fin * size_.radius);
    for (double t : {0.25, 0.6, 1.0, 1.5, 2.0}) {
      const Vec3d p = at.position + inward * (t * size_.spacing);
      if (field_.value(p) <= 0) return false;
      if (t >= 1 && (field_.value(p + aside) <= 0 || field_.value(p - aside) <= 0)) return false;
    }
    return true;
  }

  /// A few steps of Newton's method straight up or down.
  Vec3d on_surface(Vec3d p) const {
    for (int i = 0; i < 6; ++i) {
      float value = 0;
      Vec3f gradient;
      field_.gradients({&p, 1}, {&value, 1}, {&gradient, 1});
      const double slope = std::min<double>(steepest_fall, gradient.z);
      p.z -= value / slope;
    }
    return p;
  }

  struct Candidate {
    double resistance;
    Vec3d place;
  };
  static std::vector<Vec3d> softest_first(std::vector<Candidate> places) {
    std::stable_sort(places.begin(), places.end(),
                     [](const Candidate& a, const Candidate& b) { return a.resistance < b.resistance; });
    std::vector<Vec3d> points;
    for (const Candidate& candidate : places) points.push_back(candidate.place);
    return points;
  }

  const field::CompiledField& field_;
  const Ground& ground_;
  const CaveSize& size_;
  double lowest_;
  const EntranceSettings& s_;
  Progress& progress_;
  std::vector<SurfaceSample> surface_;
};

}  // namespace

Entrances choose_entrances(const field::CompiledField& field, const Ground& ground, const CaveSize& size,
                           double lowest, const EntranceSettings& settings, Progress& progress) {
  Chooser chooser(field, ground, size, lowest, settings, progress);
  return {.seeds = chooser.seeds(), .springs = chooser.springs()};
}

}  // namespace tafoni::landforms::impl
