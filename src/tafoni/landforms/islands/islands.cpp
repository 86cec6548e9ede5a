#include <algorithm>
#include <array>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/site/steepest.h"
#include "tafoni/math/noise.h"
#include "tafoni/raster/distance.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;

constexpr double full_turn = 6.28318530717958647692;

struct Params {
  std::int64_t count = 6;
  double size = 0;
  double variation = 0.35;
  double height = 0;
  double depth = 0.7;
  double relief = 0.12;
  double spacing = 1.5;
  double roots = 0.7;
  double strata = 0;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 1000,
              "most islands; points given to the layer are the middles of further ones")
        .real("size", &Params::size, "m", 0, 20000,
              "mean width of an island, 0 for a quarter of the terrain's shorter side")
        .real("variation", &Params::variation, "", 0, 0.8, "share by which sizes vary at random")
        .real("height", &Params::height, "m", 0, 20000,
              "how high the tops lie above the ground on average, 0 for 1.3 times the size")
        .real("depth", &Params::depth, "", 0.05, 3, "how deep the roots hang, as a share of the size")
        .real("relief", &Params::relief, "", 0, 1, "height of the hills on top, as a share of the size")
        .real("spacing", &Params::spacing, "", 0.5, 20,
              "least distance between middles, as a multiple of the mean of the two sizes")
        .real("roots", &Params::roots, "", 0, 1, "how much the underside is split into hanging roots")
        .real("strata", &Params::strata, "m", 0, 100,
              "how far soft beds recede, 0 for 1.5 % of the size; at most three quarters of the terrain's "
              "amplitude");
    return t;
  }();
  return params;
}

struct Island {
  Vec3d middle;  ///< of the top
  double size;
  std::uint64_t seed;
};

/// The three rasters of one island, from its outline inward.
class Shape {
 public:
  Shape(const Ground& ground, const Params& p, const Island& island)
      : ground_(ground), p_(p), island_(island), random_(island.seed, 1) {
    const double side = 1.5 * island.size;
    placement_ = {island.middle.x - 0.5 * side, island.middle.y + 0.5 * side, side / pixels, side / pixels};
    outline();
    ground_patch();
  }

  field::NodePtr tree() {
    auto top = raster(), under = raster();
    hang_roots();
    const double size = island_.size;
    hills_ = layer(0.45 * size, 5, 4);
    bends_ = {layer(0.1 * size, 3, 6), layer(0.1 * size, 3, 7)};
    rim_ = layer(0.2 * size, 2, 8);
    rough_ = layer(0.06 * size, 4, 9);
    for (int row = 0; row < pixels; ++row)
      for (int col = 0; col < pixels; ++col) {
        const double in = static_cast<double>(inside_->values.at(col, row));
        const double z = top_at(in, col, row);
        top->values.at(col, row) = static_cast<float>(z);
        under->values.at(col, row) =
            static_cast<float>(std::min(under_at(col, row, in), z - 0.02 * island_.size));
      }
    field::HeightfieldSettings settings;
    settings.influence = reach();
    settings.amplitude = ground_.site().amplitude;
    steepest_ = 1.5 * std::max(impl::steepest(*top), impl::steepest(*under));
    lowest_ = *std::min_element(under->values.values().begin(), under->values.values().end());
    highest_ = *std::max_element(top->values.values().begin(), top->values.values().end());
    const field::Domain prism{box(), inside_};
    return field::intersect(
        {field::subtract(field::heightfield(top, settings), field::heightfield(under, settings)),
         field::domain(prism, settings)});
  }

  /// Encloses the rock.
  Box3d box() const {
    const double side = placement_.dx * pixels, r = 1.5 * reach();
    return {{placement_.west, placement_.north - side, lowest_ - r},
            {placement_.west + side, placement_.north, highest_ + r}};
  }

  /// Encloses all that the tree changes. The distance of a heightfield reaches farther up over steep places.
  Box3d changed() const {
    Box3d all = box().grown(reach());
    const double up = reach() * std::hypot(1.0, steepest_);
    all.lo.z -= up;
    all.hi.z += up;
    return all;
  }

 private:
  static constexpr int pixels = 160;

  /// The influence of a small island is as small.
  double reach() const { return std::min(ground_.site().influence, 0.05 * island_.size); }

  std::shared_ptr<raster::Raster> raster() const {
    auto made = std::make_shared<raster::Raster>();
    made->placement = placement_;
    made->values = raster::Grid<float>(pixels, pixels);
    return made;
  }

  double noise(Vec2d at, double wavelength, int octaves, std::uint64_t stream) const {
    const Vec3d p{at.x / wavelength, at.y / wavelength, 0};
    return 2 * static_cast<double>(fbm(p, octaves, hash_combine(island_.seed, stream))) - 1;
  }

  /// The same at every pixel.
  raster::Grid<float> layer(double wavelength, int octaves, std::uint64_t stream) const {
    std::vector<Vec3d> places;
    for (int row = 0; row < pixels; ++row)
      for (int col = 0; col < pixels; ++col) {
        const Vec2d at = placement_.center(col, row);
        places.push_back({at.x / wavelength, at.y / wavelength, 0});
      }
    raster::Grid<float> grid(pixels, pixels);
    fbm(places, octaves, hash_combine(island_.seed, stream), grid.values());
    for (float& v : grid.values()) v = 2 * v - 1;
    return grid;
  }

  /// A ragged ring about the middle, longer than wide.
  void outline() {
    constexpr int corners = 240;
    const double turn = random_.uniform(0, full_turn), slim = random_.uniform(0.62, 0.95);
    std::vector<Vec2d> ring;
    for (int i = 0; i < corners; ++i) {
      const double a = full_turn * i / corners, c = std::cos(a), s = std::sin(a);
      const Vec2d unit{c, s};
      const double r =
          0.5 * island_.size * (1 + 0.55 * noise(unit, 1.1, 2, 2) + 0.16 * noise(unit, 0.17, 3, 3));
      const double x = r * c, y = r * s * slim;
      ring.push_back({island_.middle.x + x * std::cos(turn) - y * std::sin(turn),
                      island_.middle.y + x * std::sin(turn) + y * std::cos(turn)});
    }
    auto in = raster();
    in->values = raster::signed_distance({ring}, placement_, pixels, pixels, 0.5 * island_.size);
    deepest_ = static_cast<double>(*std::max_element(in->values.values().begin(), in->values.values().end()));
    inside_ = std::move(in);
  }

  /// A piece of the site's own relief, without its mean slope.
  void ground_patch() {
    const Box3d& box = ground_.box();
    const double half = 0.5 * placement_.dx * pixels;
    const auto within = [&](double lo, double hi) {
      return hi - lo > 2 * half ? random_.uniform(lo + half, hi - half) : 0.5 * (lo + hi);
    };
    const Vec2d from{within(box.lo.x, box.hi.x), within(box.lo.y, box.hi.y)};
    patch_ = raster::Grid<float>(pixels, pixels);
    double sum = 0, sx = 0, sy = 0, sxx = 0;
    for (int row = 0; row < pixels; ++row)
      for (int col = 0; col < pixels; ++col) {
        const double x = (col + 0.5 - 0.5 * pixels) * placement_.dx,
                     y = (0.5 * pixels - row - 0.5) * placement_.dy;
        const double h = ground_.height(std::clamp(from.x + x, box.lo.x, box.hi.x),
                                        std::clamp(from.y + y, box.lo.y, box.hi.y));
        patch_.at(col, row) = static_cast<float>(h);
        sum += h, sx += h * x, sy += h * y, sxx += x * x;
      }
    double square = 0;
    for (int row = 0; row < pixels; ++row)
      for (int col = 0; col < pixels; ++col) {
        const double x = (col + 0.5 - 0.5 * pixels) * placement_.dx,
                     y = (0.5 * pixels - row - 0.5) * placement_.dy;
        const double h =
            static_cast<double>(patch_.at(col, row)) - sum / (pixels * pixels) - (sx * x + sy * y) / sxx;
        patch_.at(col, row) = static_cast<float>(h);
        square += h * h;
      }
    const double spread = std::sqrt(square / (pixels * pixels));
    patch_scale_ = std::min(1.0, 0.3 * p_.relief * island_.size / std::max(spread, 1e-6));
  }

  double top_at(double in, int col, int row) const {
    const double size = island_.size;
    const double hills = patch_scale_ * static_cast<double>(patch_.at(col, row)) +
                         0.35 * p_.relief * size * static_cast<double>(hills_.at(col, row));
    // Higher in the middle; the rim is worn round.
    const double dome = 0.5 * p_.relief * size * std::sqrt(std::clamp(in / deepest_, 0.0, 1.0));
    const double worn = 0.03 * size * (1 - smoothstep(-0.02 * size, 0.06 * size, in));
    return island_.middle.z + hills + dome - worn;
  }

  /// Spikes of rock under the middle, shorter towards the rim.
  void hang_roots() {
    SpatialHash apart(0.2 * island_.size);
    for (int i = 0; i < 160; ++i) {
      const Vec2d at = placement_.center(random_.uniform(0, pixels - 1), random_.uniform(0, pixels - 1));
      const Vec2d px = placement_.pixel(at.x, at.y);
      const double in = static_cast<double>(
          inside_->values.at(static_cast<int>(std::lround(px.x)), static_cast<int>(std::lround(px.y))));
      const double share = in / deepest_;
      const double length = island_.size * p_.depth * (0.25 + 0.75 * share) * random_.uniform(0.45, 1.0);
      const double width = island_.size * random_.uniform(0.08, 0.2) * (0.5 + share);
      if (share < 0.1 || apart.any_near({at.x, at.y, 0}, 0.09 * island_.size)) continue;
      apart.insert({at.x, at.y, 0});
      roots_.push_back({at, width, length});
    }
  }

  double under_at(int col, int row, double in) const {
    const double size = island_.size, share = std::clamp(in / deepest_, 0.0, 1.0);
    // Buttresses: the taper starts from a jagged line.
    const Vec2d bend{bends_[0].at(col, row), bends_[1].at(col, row)};
    const Vec2d bent = placement_.center(col, row) + bend * (0.05 * size);
    double root = 0;
    for (const Root& r : roots_) {
      const double d = std::hypot(bent.x - r.at.x, bent.y - r.at.y) / r.width;
      if (d < 1) root = std::max(root, r.length * std::pow(1 - d, 1.3) * std::min(1.0, 3 * share));
    }
    const double bulk = p_.depth * size * 0.62 * std::pow(share, 0.85);
    const double rim = size * (0.045 + 0.03 * static_cast<double>(rim_.at(col, row)));
    const double rough = 0.05 * size * static_cast<double>(rough_.at(col, row)) * std::min(1.0, 4 * share);
    return island_.middle.z - rim - bulk * (1 - 0.35 * p_.roots) - p_.roots * root + rough;
  }

  struct Root {
    Vec2d at;
    double width, length;
  };

  const Ground& ground_;
  const Params& p_;
  Island island_;
  Random random_;
  raster::Placement placement_;
  std::shared_ptr<const raster::Raster> inside_;
  raster::Grid<float> patch_, hills_, rim_, rough_;
  std::array<raster::Grid<float>, 2> bends_;
  std::vector<Root> roots_;
  double deepest_ = 1, patch_scale_ = 1, lowest_ = 0, highest_ = 0, steepest_ = 0;
};

/// Where the islands float: the user's points first, then at random over the site.
class Placing {
 public:
  Placing(const Ground& ground, const Params& p)
      : ground_(ground), p_(p), random_(ground.site().seed, 0x151) {
    const Vec3d extent = ground.box().size();
    mean_ = p.size > 0 ? p.size : 0.25 * std::min(extent.x, extent.y);
    height_ = p.height > 0 ? p.height : 1.3 * mean_;
  }

  std::vector<Island> run() {
    for (Vec3d at : ground_.site().points)
      if (ground_.usable(at)) islands_.push_back({at, size(), random_.next()});
    const Box3d& box = ground_.box();
    const std::size_t most = islands_.size() + static_cast<std::size_t>(p_.count);
    for (std::int64_t i = 0; islands_.size() < most && i < 60 * p_.count; ++i) {
      Island island{{random_.uniform(box.lo.x, box.hi.x), random_.uniform(box.lo.y, box.hi.y), 0},
                    size(),
                    random_.next()};
      Vec3d& p = island.middle;
      p.z = ground_.height(p.x, p.y) + height_ * random_.uniform(0.75, 1.25);
      fit(island);
      if (clear(island)) islands_.push_back(island);
    }
    return std::move(islands_);
  }

 private:
  double size() { return mean_ * (1 + p_.variation * random_.uniform(-1, 1)); }

  /// Where the region is limited in height, the island hangs within its limits.
  void fit(Island& island) const {
    if (!ground_.site().region) return;
    const Box3d limit = ground_.site().region->bounds();
    const double above = p_.relief * island.size, below = 1.1 * p_.depth * island.size;
    island.middle.z = std::max(std::min(island.middle.z, limit.hi.z - above), limit.lo.z + below);
  }

  bool clear(const Island& island) const {
    if (!ground_.usable(island.middle)) return false;
    for (int i = 0; i < 12; ++i) {
      const double a = full_turn * i / 12;
      const Vec3d rim = island.middle + Vec3d{std::cos(a), std::sin(a), 0} * (0.6 * island.size);
      if (!ground_.usable(rim)) return false;
    }
    return std::none_of(islands_.begin(), islands_.end(), [&](const Island& other) {
      const Vec3d d = other.middle - island.middle;
      return std::hypot(d.x, d.y) < 0.5 * p_.spacing * (island.size + other.size);
    });
  }

  const Ground& ground_;
  const Params& p_;
  Random random_;
  double mean_, height_;
  std::vector<Island> islands_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "islands");
  const Ground ground(site);
  const std::vector<Island> islands = ground.box().empty() ? std::vector<Island>{} : Placing(ground, p).run();
  std::vector<field::NodePtr> trees(islands.size());
  std::vector<Box3d> boxes(islands.size());
  progress.begin("raising islands", islands.size(), "islands");
  parallel_for(
      static_cast<std::int64_t>(islands.size()),
      [&](std::int64_t i) {
        Shape shape(ground, p, islands[static_cast<std::size_t>(i)]);
        trees[static_cast<std::size_t>(i)] = shape.tree();
        boxes[static_cast<std::size_t>(i)] = shape.changed();
      },
      progress);
  progress.end();
  progress.check();
  Result result;
  std::vector<double> places, sizes;
  for (const Island& island : islands) {
    const Vec3d world = island.middle + site.origin;
    places.insert(places.end(), {world.x, world.y, world.z});
    sizes.push_back(island.size);
  }
  result.report = {{"islands", static_cast<std::int64_t>(islands.size())},
                   {"positions", places},
                   {"sizes_m", sizes},
                   {"primitives", std::int64_t{0}}};
  if (islands.empty()) return result;
  for (const Box3d& box : boxes) result.reshaped.expand(box);
  for (std::size_t i = 0; site.geology && i < trees.size(); ++i) {
    const double depth = p.strata > 0 ? p.strata : 0.015 * islands[i].size;
    trees[i] = field::erode(std::move(trees[i]), nullptr, geology::as_function(site.geology),
                            std::min(depth, 0.75 * site.amplitude));
  }
  result.reshape = [trees](field::NodePtr tree) {
    std::vector<field::NodePtr> all = {std::move(tree)};
    all.insert(all.end(), trees.begin(), trees.end());
    return field::unite(std::move(all));
  };
  return result;
}

}  // namespace

const LandformType& landform_islands() {
  static const LandformType type{
      .about = {.name = "islands",
                .doc = "Floating islands: each the rock between a piece of terrain and an inverted one",
                .source = "[Paris19 §5.1, fig. 20]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
