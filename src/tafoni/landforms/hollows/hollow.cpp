// Tunnels and chambers carved into one scalar grid. What the tree gets is a function of it: walls textured as
// bedded rock, rims worn round where they meet the ground, fenced by the region's control field.

#include "tafoni/landforms/hollows/hollow.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/math/lattice.h"
#include "tafoni/volume/sample.h"

namespace tafoni::landforms::impl {
namespace {

using volume::ScalarGrid;

enum class HollowStream : std::uint64_t { walls = 0x407 };

/// Chosen by eye.
namespace hollow_look {
// Spacing of the samples, in radii of a tunnel and in metres at least; the wavelength of walls, in radii.
constexpr double spacing = 0.2, least_spacing = 0.05, wavelength = 1.6;
// Rims are worn over so many samples, and so far at the region's border fades the hollow in; but over no more
// than this share of the amplitude.
constexpr double worn = 2, most_worn = 0.3;
// Metres between the points of a route: close enough for the way between them to stay off the walls.
constexpr double route_step = 1;
// Step of gradients, in samples.
constexpr double gradient_step = 0.3;
}  // namespace hollow_look

class HollowShape final : public RockShape {
 public:
  HollowShape(ScalarGrid grid, const RockTexture& texture) : RockShape(texture), grid_(std::move(grid)) {}

 private:
  double body(Vec3d p) const override { return -double{grid_.value(p)}; }
  Range body_range(const Box3d& box) const override {
    const Interval r = grid_.range(box);
    return {-double{r.hi}, -double{r.lo}};
  }
  double step() const override { return hollow_look::gradient_step * grid_.frame().spacing; }

  ScalarGrid grid_;
};

/// An opening whose rims are worn round: where it comes near to the tree's own surface it is a little larger,
/// by a smooth minimum of both.
class WornRims final : public field::Function {
 public:
  WornRims(field::FunctionPtr opening, field::FunctionPtr tree, double radius)
      : opening_(std::move(opening)), tree_(std::move(tree)), radius_(static_cast<float>(radius)) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    opening_->values(points, out);
    const Near near = near_of(points, out);
    for (std::size_t i = 0; i < near.which.size(); ++i) {
      float& v = out[near.which[i]];
      const Meeting m = meeting(near.solid[i], v);
      if (m.h > 0) v = std::max(v, -std::min(near.solid[i], -v) + 0.25f * m.h * m.h / m.k);
    }
  }

  /// The gradients of both surfaces, weighed as they are in the minimum: the values jump where the tree's
  /// surface takes over, although what is left of the tree does not.
  void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const override {
    std::vector<float> opening(points.size());
    opening_->values(points, opening);
    opening_->gradients(points, out);
    const Near near = near_of(points, opening);
    std::vector<Vec3f> slopes(near.points.size());
    tree_->gradients(near.points, slopes);
    for (std::size_t i = 0; i < near.which.size(); ++i) {
      const float v = opening[near.which[i]], a = near.solid[i];
      const Meeting m = meeting(a, v);
      if (m.h <= 0) continue;
      const float share = 0.5f * m.h / m.k, tree = a < -v ? 1 - share : share;
      Vec3f& g = out[near.which[i]];
      g = g * (1 - tree) - slopes[i] * tree;
    }
  }
  double step() const override { return opening_->step(); }
  Interval range(const Box3d& box) const override {
    const Interval r = opening_->range(box);
    if (r.hi <= -2 * radius_ || r.lo >= 2 * radius_) return r;
    return {r.lo, std::max(r.hi, std::min(r.hi, 2 * radius_) + 2.25f * radius_)};
  }

 private:
  struct Near {
    std::vector<Vec3d> points;
    std::vector<std::size_t> which;
    std::vector<float> solid;  ///< the tree's values
  };
  Near near_of(std::span<const Vec3d> points, std::span<const float> opening) const {
    Near near;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(opening[i]) < 2 * radius_) near.points.push_back(points[i]), near.which.push_back(i);
    near.solid.resize(near.points.size());
    tree_->values(near.points, near.solid);
    return near;
  }

  struct Meeting {
    float k, h;  ///< over how much they meet, and how closely they do
  };
  /// They meet nowhere beyond twice the radius from the wall.
  Meeting meeting(float solid, float opening) const {
    const float k = radius_ * (1 - std::abs(opening) / (2 * radius_));
    return {k, std::max(k - std::abs(solid + opening), 0.0f)};
  }

  field::FunctionPtr opening_, tree_;
  float radius_;
};

/// T inside the region, -T outside of it, without a jump.
class Fence final : public field::Function {
 public:
  Fence(field::FunctionPtr control, double amplitude)
      : control_(std::move(control)), amplitude_(static_cast<float>(amplitude)) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    control_->values(points, out);
    for (float& v : out) v = amplitude_ * (2 * v - 1);
  }
  Interval range(const Box3d& box) const override {
    const Interval r = control_->range(box);
    return {amplitude_ * (2 * r.lo - 1), amplitude_ * (2 * r.hi - 1)};
  }

 private:
  field::FunctionPtr control_;
  float amplitude_;
};

/// Cubic metres of rock that were where it is open now.
double carved_volume(const ScalarGrid& grid, const field::NodePtr& before) {
  const field::CompiledField field = field::compile(before);
  const volume::GridFrame frame = grid.frame();
  const Vec3i chunks = grid.chunks();
  constexpr int side = ScalarGrid::chunk_samples;
  const std::int64_t n = std::int64_t{chunks.x} * chunks.y * chunks.z;
  std::vector<std::int64_t> counts(n, 0);
  parallel_for(n, [&](std::int64_t c) {
    const Vec3i at = sample_at(chunks, c);
    if (grid.uniform(at)) return;
    const Vec3i lo{at.x * side, at.y * side, at.z * side};
    std::vector<Vec3d> open;
    for (int z = lo.z; z < std::min(lo.z + side, frame.size.z); ++z)
      for (int y = lo.y; y < std::min(lo.y + side, frame.size.y); ++y)
        for (int x = lo.x; x < std::min(lo.x + side, frame.size.x); ++x)
          if (grid.at({x, y, z}) < 0) open.push_back(frame.position({x, y, z}));
    std::vector<float> values(open.size());
    field.values(open, values);
    counts[c] = std::count_if(values.begin(), values.end(), [](float v) { return v > 0; });
  });
  std::int64_t sum = 0;
  for (const std::int64_t count : counts) sum += count;
  return static_cast<double>(sum) * frame.spacing * frame.spacing * frame.spacing;
}

}  // namespace

Hollow::Hollow(const Ground& ground, const HollowParams& params, double radius) : ground_(ground) {
  const Site& site = ground.site();
  spacing_ = params.spacing > 0 ? params.spacing
                                : std::max(hollow_look::spacing * radius, hollow_look::least_spacing);
  texture_.geology = site.geology;
  texture_.relief = -params.relief;
  texture_.unevenness = params.roughness;
  texture_.wavelength = hollow_look::wavelength * radius;
  texture_.amplitude = site.amplitude;
  texture_.origin = site.origin;
  texture_.seed = hash_combine(site.seed, HollowStream::walls);
}

Box3d Hollow::bounds(double reach) const {
  Box3d box;
  for (const volume::Tunnel& t : tunnels_) box.expand(volume::bounds(t, reach));
  for (const volume::Chamber& c : chambers_) box.expand(c.bounds().grown(reach));
  return box;
}

void Hollow::tell_routes(Facts& facts) const {
  std::vector<Vec3d> routes;
  std::vector<double> points;
  double length = 0;
  for (const volume::Tunnel& t : tunnels_) {
    length += volume::length(t);
    double since = 1e9;
    int count = 0;
    for (std::size_t i = 0; i < t.axis.size(); ++i) {
      const volume::AxisPoint& a = t.axis[i];
      if (i > 0) since += tafoni::length(a.position - t.axis[i - 1].position);
      if (since < hollow_look::route_step && i + 1 < t.axis.size()) continue;
      since = 0;
      routes.push_back(a.position - Vec3d{0, 0, std::min(t.floor, a.radius)});
      ++count;
    }
    points.push_back(count);
  }
  facts.count("tunnels", std::ssize(tunnels_))
      .about("Tunnels that were dug")
      .length("tunnel_length", length)
      .about("Length of the axes of all tunnels")
      .places("routes", routes)
      .about("x, y and z of places on the floors, tunnel after tunnel")
      .numbers("route_points", points)
      .about("How many of the places in routes belong to each tunnel");
}

void Hollow::check_size(double reach) const {
  double volume = 0;
  for (const volume::Tunnel& t : tunnels_) {
    double widest = 0;
    for (const volume::AxisPoint& a : t.axis) widest = std::max(widest, a.radius);
    volume += (volume::length(t) + 2 * (widest + reach)) * 4 * (widest + reach) * (widest + reach);
  }
  for (const volume::Chamber& c : chambers_) {
    const Vec3d size = c.bounds().size();
    volume += size.x * size.y * size.z;
  }
  constexpr double most = 0x1p31;
  if (volume > most * spacing_ * spacing_ * spacing_)
    fail(ErrorKind::usage,
         "{:.3g} m3 about what is dug, at a spacing of {:g} m, are more than 2^31 samples; give a spacing of "
         "{:.2g} m or more",
         volume, spacing_, 1.05 * std::cbrt(volume / most));
}

Result Hollow::finish(Progress& progress) const {
  Result result;
  const Site& site = ground_.site();
  tell_routes(result.facts);
  const double margin = 0.5 * std::abs(texture_.relief) + texture_.unevenness;
  const double reach = site.amplitude + margin + spacing_;
  const Box3d box = bounds(reach + 2 * spacing_);
  if (box.empty()) {
    result.facts.volume("volume", 0).about("Volume of the rock that was taken away");
    return result;
  }
  check_size(reach);
  ScalarGrid grid(volume::frame_over(box, spacing_), static_cast<float>(reach));
  volume::carve(grid, tunnels_, reach, progress);
  for (const volume::Chamber& chamber : chambers_) {
    progress.check();
    volume::carve(grid, chamber);
  }
  result.facts.volume("volume", carved_volume(grid, site.terrain))
      .about("Volume of the rock that was taken away");
  const auto shape = std::make_shared<HollowShape>(std::move(grid), texture_);
  const auto control = control_of(site, hollow_look::worn * spacing_);
  result.reshaped = box;
  result.reshape = [shape, control, worn = hollow_look::worn * spacing_,
                    t = site.amplitude](field::NodePtr tree) {
    const auto limit = static_cast<float>(t);
    field::NodePtr cut = field::function(std::make_shared<WornRims>(
        shape, field::as_function(tree, -limit, limit), std::min(worn, hollow_look::most_worn * t)));
    if (control)
      cut = field::intersect({std::move(cut), field::function(std::make_shared<Fence>(control, t))});
    return field::subtract(std::move(tree), std::move(cut));
  };
  return result;
}

}  // namespace tafoni::landforms::impl
