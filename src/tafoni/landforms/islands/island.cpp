// An island has three rasters: the signed distance to its outline, from which all else follows; a top with a
// piece of the site's own relief and hills of its own; an underside that hangs down by that distance, split
// into roots. Its tree is the rock below the top, above the underside and within the outline.

#include "tafoni/landforms/islands/island.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/site/steepest_slope.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/distance.h"

namespace tafoni::landforms::impl {
namespace {

/// Of an island's own seed.
enum class IslandStream : std::uint64_t {
  choices = 1,
  outline = 2,
  rags = 3,
  hills = 4,
  bend_x = 6,
  bend_y = 7,
  rim = 8,
  roughness = 9
};

constexpr int pixels = 160;  // of each raster's side: finer than any voxel that shows a whole island

// Chosen by eye; shares of the island's size unless said otherwise.
constexpr double raster_side = 1.5;                 // rags reach beyond the mean width
constexpr double thinnest = 0.02;                   // rock at the rim
constexpr double most_influence = 0.05;             // the influence of a small island is as small
constexpr double slimmest = 0.62, roundest = 0.95;  // width over length
constexpr double ground_share = 0.3, hill_share = 0.35, dome_share = 0.5;  // of the relief
constexpr double rim_wear = 0.03;                                          // the rim is worn round by so much
constexpr int root_tries = 160;
constexpr double root_free = 0.1;  // of the way from the rim inward: no roots hang there
constexpr double roots_apart = 0.09;
constexpr double root_taper = 1.3;                      // exponent: spikes, not cones
constexpr double buttress = 0.05;                       // how far the taper's jagged line swings
constexpr double bulk_share = 0.62, bulk_taper = 0.85;  // of the depth; exponent
constexpr double roots_take = 0.35;                     // share of the bulk that turns into roots
constexpr double rim_thickness = 0.045, rim_change = 0.03;
constexpr double roughness = 0.05;

class Shape {
 public:
  Shape(const Ground& ground, const Island& island, const IslandSettings& settings)
      : ground_(ground), p_(settings), island_(island), random_(island.seed, IslandStream::choices) {
    const double side = raster_side * island.size;
    placement_ = {island.middle.x - 0.5 * side, island.middle.y + 0.5 * side, side / pixels, side / pixels};
    outline();
    ground_patch();
  }

  field::NodePtr tree() {
    auto top = raster(), under = raster();
    hang_roots();
    const double size = island_.size;
    hills_ = layer(0.45 * size, 5, IslandStream::hills);
    bends_ = {layer(0.1 * size, 3, IslandStream::bend_x), layer(0.1 * size, 3, IslandStream::bend_y)};
    rim_ = layer(0.2 * size, 2, IslandStream::rim);
    rough_ = layer(0.06 * size, 4, IslandStream::roughness);
    for (int row = 0; row < pixels; ++row)
      for (int col = 0; col < pixels; ++col) {
        const double in = inside_->values.at(col, row);
        const double z = top_at(in, col, row);
        top->values.at(col, row) = static_cast<float>(z);
        under->values.at(col, row) =
            static_cast<float>(std::min(under_at(col, row, in), z - thinnest * island_.size));
      }
    field::HeightfieldSettings settings;
    settings.influence = reach();
    settings.amplitude = ground_.site().amplitude;
    steepest_ = 1.5 * std::max(steepest_slope(*top), steepest_slope(*under));
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

  /// Encloses all that a union with the tree changes. The distance of a heightfield reaches farther up over
  /// steep places.
  Box3d changed() const {
    Box3d all = box().grown(reach());
    const double up = reach() * std::hypot(1.0, steepest_);
    all.lo.z -= up;
    all.hi.z += up;
    return all;
  }

 private:
  /// The influence of a small island is as small.
  double reach() const { return std::min(ground_.site().influence, most_influence * island_.size); }

  std::shared_ptr<raster::Raster> raster() const {
    auto made = std::make_shared<raster::Raster>();
    made->placement = placement_;
    made->values = raster::Grid<float>(pixels, pixels);
    return made;
  }

  double noise(Vec2d at, double wavelength, int octaves, IslandStream stream) const {
    const Vec3d p{at.x / wavelength, at.y / wavelength, 0};
    return 2 * double{fbm(p, octaves, hash_combine(island_.seed, stream))} - 1;
  }

  /// The same at every pixel.
  raster::Grid<float> layer(double wavelength, int octaves, IslandStream stream) const {
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
    const double turn = random_.uniform(0, full_turn), slim = random_.uniform(slimmest, roundest);
    std::vector<Vec2d> ring;
    for (int i = 0; i < corners; ++i) {
      const double a = full_turn * i / corners, c = std::cos(a), s = std::sin(a);
      const Vec2d unit{c, s};
      const double r = 0.5 * island_.size *
                       (1 + 0.55 * noise(unit, 1.1, 2, IslandStream::outline) +
                        0.16 * noise(unit, 0.17, 3, IslandStream::rags));
      const double x = r * c, y = r * s * slim;
      ring.push_back({island_.middle.x + x * std::cos(turn) - y * std::sin(turn),
                      island_.middle.y + x * std::sin(turn) + y * std::cos(turn)});
    }
    auto in = raster();
    in->values = raster::signed_distance({ring}, placement_, pixels, pixels, 0.5 * island_.size);
    deepest_ = *std::max_element(in->values.values().begin(), in->values.values().end());
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
        const double h = patch_.at(col, row) - sum / (pixels * pixels) - (sx * x + sy * y) / sxx;
        patch_.at(col, row) = static_cast<float>(h);
        square += h * h;
      }
    const double spread = std::sqrt(square / (pixels * pixels));
    patch_scale_ = std::min(1.0, ground_share * p_.relief * island_.size / std::max(spread, 1e-6));
  }

  double top_at(double in, int col, int row) const {
    const double size = island_.size;
    const double hills =
        patch_scale_ * patch_.at(col, row) + hill_share * p_.relief * size * hills_.at(col, row);
    // Higher in the middle; the rim is worn round.
    const double dome = dome_share * p_.relief * size * std::sqrt(std::clamp(in / deepest_, 0.0, 1.0));
    const double worn = rim_wear * size * (1 - smoothstep(-0.02 * size, 0.06 * size, in));
    return island_.middle.z + hills + dome - worn;
  }

  /// Spikes of rock under the middle, shorter towards the rim.
  void hang_roots() {
    SpatialHash apart(0.2 * island_.size);
    for (int i = 0; i < root_tries; ++i) {
      const Vec2d at = placement_.center(random_.uniform(0, pixels - 1), random_.uniform(0, pixels - 1));
      const Vec2d px = placement_.pixel(at.x, at.y);
      const double in = inside_->values.at(round_to(px.x), round_to(px.y));
      const double share = in / deepest_;
      const double length = island_.size * p_.depth * (0.25 + 0.75 * share) * random_.uniform(0.45, 1.0);
      const double width = island_.size * random_.uniform(0.08, 0.2) * (0.5 + share);
      if (share < root_free || apart.any_near({at.x, at.y, 0}, roots_apart * island_.size)) continue;
      apart.insert({at.x, at.y, 0});
      roots_.push_back({at, width, length});
    }
  }

  double under_at(int col, int row, double in) const {
    const double size = island_.size, share = std::clamp(in / deepest_, 0.0, 1.0);
    // Buttresses: the taper starts from a jagged line.
    const Vec2d bend{bends_[0].at(col, row), bends_[1].at(col, row)};
    const Vec2d bent = placement_.center(col, row) + bend * (buttress * size);
    double root = 0;
    for (const Root& r : roots_) {
      const double d = std::hypot(bent.x - r.at.x, bent.y - r.at.y) / r.width;
      if (d < 1) root = std::max(root, r.length * std::pow(1 - d, root_taper) * std::min(1.0, 3 * share));
    }
    const double bulk = p_.depth * size * bulk_share * std::pow(share, bulk_taper);
    const double rim = size * (rim_thickness + rim_change * rim_.at(col, row));
    const double rough = roughness * size * rough_.at(col, row) * std::min(1.0, 4 * share);
    return island_.middle.z - rim - bulk * (1 - roots_take * p_.roots) - p_.roots * root + rough;
  }

  struct Root {
    Vec2d at;
    double width, length;
  };

  const Ground& ground_;
  const IslandSettings& p_;
  Island island_;
  Random random_;
  raster::Placement placement_;
  std::shared_ptr<const raster::Raster> inside_;
  raster::Grid<float> patch_, hills_, rim_, rough_;
  std::array<raster::Grid<float>, 2> bends_;
  std::vector<Root> roots_;
  double deepest_ = 1, patch_scale_ = 1, lowest_ = 0, highest_ = 0, steepest_ = 0;
};

}  // namespace

IslandTree make_island(const Ground& ground, const Island& island, const IslandSettings& settings) {
  Shape shape(ground, island, settings);
  field::NodePtr tree = shape.tree();
  return {std::move(tree), shape.changed()};
}

}  // namespace tafoni::landforms::impl
