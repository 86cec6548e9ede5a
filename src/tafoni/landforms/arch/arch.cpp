// Arches: looks from sampled faces for thin walls, for rims with room for a shaft behind them and for faces
// that stand opposite each other, judges each by its rock, and takes the best that leave a sound roof, as
// windows cut out of the tree and bridges united with it [Paris19 §6.1].

#include <algorithm>
#include <cmath>
#include <optional>

#include "tafoni/core/random.h"
#include "tafoni/landforms/arch/openings.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::landforms::landform_arch {
namespace {

using impl::Ground;

enum class Stream : std::uint64_t { faces = 0xa7c4, rock = 0x7e, bridges = 0xb1 };

struct Params {
  std::int64_t count = 6;
  double size = 0;
  double thickness = 0;
  double roof = 0;
  double slope = 40;
  bool potholes = true;
  std::int64_t bridges = 0;
  double span = 0;
  double weakness = 0.5;
  double roughness = 0.5;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 1000,
              "Most openings that are sought in fins, ridges and cliffs")
        .real("size", &Params::size, "m", 0, 500,
              "Greatest height of an opening; 0 for three pixels of the terrain, but 18 m at least")
        .real(
            "thickness", &Params::thickness, "m", 0, 1000,
            "Thickest wall that an arch may pierce: more finds arches like tunnels; 0 for 1.2 times the size")
        .real("roof", &Params::roof, "m", 0, 200,
              "Least rock that is left above an opening; 0 for a fifth of the size")
        .real("slope", &Params::slope, "deg", 10, 89, "Slope from which ground counts as a face")
        .boolean("potholes", &Params::potholes,
                 "Whether cliffs are opened into a shaft behind their rim where no thin wall is left: "
                 "pothole arches")
        .integer("bridges", &Params::bridges, "", 0, 1000,
                 "Most natural bridges that are built between faces that stand opposite each other")
        .real("span", &Params::span, "m", 0, 1000, "Longest of these bridges; 0 for three times the size")
        .only("where bridges is above 0", {{"bridges", std::int64_t{4}}})
        .real("weakness", &Params::weakness, "", 0, 1,
              "How much wider openings are where the rock is soft; 0 for openings of even width")
        .real("roughness", &Params::roughness, "", 0, 1,
              "Unevenness of the rock in openings and bridges; 0 for smooth vaults");
    return t;
  }();
  return params;
}

/// A place where something may be built, the best first.
template <class T>
struct Found {
  double merit;
  T what;
};

class Arches {
 public:
  Arches(const Site& site, const Params& p, Progress& progress)
      : p_(p), ground_(site), field_(field::compile(site.terrain)), progress_(progress) {
    size_ = p.size > 0 ? p.size : std::max(18.0, 3 * ground_.pixel());
    thickness_ = p.thickness > 0 ? p.thickness : 1.2 * size_;
    roof_ = p.roof > 0 ? p.roof : 0.2 * size_;
    span_ = p.span > 0 ? p.span : 3 * size_;
    step_ = size_ / 16;
    taken_.emplace(4 * size_);
  }

  Result run() {
    if (!ground_.box().empty()) {
      user_bridges();
      if (p_.count > 0 || p_.bridges > 0) search();
    }
    return finish();
  }

 private:
  // --- Looking about ---

  bool solid(Vec3d p) const { return field_.value(p) > 0; }

  /// The way from `p` along `d` until it is rock (or air), at most `far`; negative when it stays otherwise.
  double until(bool rock, Vec3d p, Vec3d d, double far) const {
    std::vector<Vec3d> line;
    for (double t = step_; t <= far; t += step_) line.push_back(p + d * t);
    std::vector<float> values(line.size());
    field_.values(line, values);
    for (std::size_t i = 0; i < values.size(); ++i)
      if ((values[i] > 0) == rock) return step_ * static_cast<double>(i + 1);
    return -1;
  }

  void search() {
    SurfaceSampling sampling;
    const Vec3d extent = ground_.box().size();
    sampling.spacing = std::clamp(std::max(extent.x, extent.y) / 400, 0.3 * size_, 2 * size_);
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, Stream::faces);
    const auto steep = static_cast<float>(std::cos(p_.slope * degree));
    sampling.accept = [&](const SurfaceSample& at) {
      return std::abs(at.normal.z) < steep && ground_.usable(at.position, 0.5 * size_);
    };
    const auto faces = sample_surface(field_, sampling, progress_);
    std::vector<Found<impl::Window>> fins, cliffs;
    std::vector<Found<impl::Bridge>> gaps;
    progress_.begin("looking for arches", faces.size(), "faces");
    for (const SurfaceSample& face : faces) {
      progress_.advance();
      progress_.check();
      if (p_.count > 0) {
        if (auto fin = through_fin(face))
          fins.push_back(*fin);
        else if (p_.potholes) {
          if (auto cliff = behind_rim(face)) cliffs.push_back(*cliff);
        }
      }
      if (p_.bridges > 0)
        if (auto gap = across_gap(face)) gaps.push_back(*gap);
    }
    progress_.end();
    take_windows(fins);
    take_windows(cliffs);
    take_bridges(gaps);
  }

  /// The height of what stands in the air at `p`: where it first meets rock below; nothing if too far down.
  std::optional<double> foot(Vec3d p) const {
    const double down = until(true, p, {0, 0, -1}, 2 * size_);
    if (down < 0 || solid(p)) return {};
    return p.z - down;
  }

  /// Mean resistance about a place.
  double resistance(Vec3d p, double around) const {
    std::vector<Vec3d> places;
    for (double z : {-0.8, -0.4, 0.0, 0.4, 0.8}) places.push_back(p + Vec3d{0, 0, z * around});
    std::vector<float> rho(places.size());
    ground_.resistances(places, rho);
    double sum = 0;
    for (float r : rho) sum += r;
    return sum / static_cast<double>(rho.size());
  }

  /// A window from the face to the air behind it.
  std::optional<Found<impl::Window>> through_fin(const SurfaceSample& face) const {
    const Vec3d inward = normalized(Vec3d{-to_double(face.normal).x, -to_double(face.normal).y, 0});
    const Vec3d start = face.position + inward * (2 * step_);
    const double wall = until(false, start, inward, thickness_);
    if (wall < 0) return {};
    const double out = 2 * step_;
    const Vec3d before = face.position - inward * out, behind = start + inward * (wall + out);
    const auto foot0 = foot(before), foot1 = foot(behind);
    if (!foot0 || !foot1) return {};
    impl::Window w;
    w.through = inward;
    w.center = 0.5 * (before + behind);
    w.half_length = 0.5 * length(behind - before) + out;
    return fit_opening(w, std::max(*foot0, *foot1), face.position.z);
  }

  /// A window from the face to a shaft that opens behind the rim: as near as rock enough is left between
  /// them.
  std::optional<Found<impl::Window>> behind_rim(const SurfaceSample& face) const {
    const Vec3d inward = normalized(Vec3d{-to_double(face.normal).x, -to_double(face.normal).y, 0});
    const Vec3d before = face.position - inward * (2 * step_);
    const auto low = foot(before);
    if (!low) return {};
    const double radius = 0.28 * size_;
    for (double strip : {0.45 * size_, 0.9 * size_, 1.5 * size_}) {
      const double depth = std::max(1.2 * roof_, strip) + 1.1 * radius;
      const Vec3d behind = face.position + inward * depth;
      const double up = until(false, behind, {0, 0, 1}, 2.2 * size_);
      if (up < 0 || !solid(behind)) continue;
      bool bears = true;
      for (double z : {0.3, 0.5, 0.7})
        bears = bears && solid(behind - inward * (1.6 * radius) + Vec3d{0, 0, z * up});
      if (!bears) continue;
      impl::Window w;
      w.through = inward;
      w.half_length = 0.5 * (depth + 6 * step_);
      w.center = before + inward * (w.half_length - 2 * step_);
      w.shaft_at = dot(behind - w.center, inward);
      w.shaft_radius = radius;
      auto made = fit_opening(w, *low, face.position.z);
      if (!made) return {};
      made->what.shaft_top = behind.z + up + 0.5 * size_ - made->what.center.z;
      made->merit -= 0.5;
      return made;
    }
    return {};
  }

  /// Fits the opening between the ground at its foot and the roof that must remain above it.
  std::optional<Found<impl::Window>> fit_opening(impl::Window w, double floor, double z) const {
    Vec3d middle = w.center;
    middle.z = z;
    const Vec3d roofed = w.shaft_radius > 0
                             ? middle - w.through * (dot(middle - w.center, w.through) + 0.25 * w.half_length)
                             : middle;
    if (!solid(roofed)) return {};
    const double up = until(false, roofed, {0, 0, 1}, 6 * size_);
    const double top = roofed.z + (up < 0 ? 6 * size_ : up);
    const double sway = texture(1).unevenness + 0.5 * std::abs(texture(1).relief);
    const double height = std::min(size_, 0.72 * (top - floor - roof_) - sway);
    if (height < 0.3 * size_) return {};
    w.half_height = 0.5 * height;
    w.center.z = floor + w.half_height + 0.02 * height;
    // Judged once, from about the middle of its height.
    if (std::abs(z - w.center.z) > 0.6 * w.half_height) return {};
    const double rho = resistance(w.center, w.half_height);
    const double wanted = w.half_height * (1.45 - 0.85 * smoothstep(0.15, 0.75, rho));
    double free = wanted;
    for (double hand : {-1.0, 1.0}) {
      const double wall = until(false, roofed, w.along() * hand, 2.5 * wanted);
      if (wall > 0) free = std::min(free, 0.6 * wall);
    }
    w.half_width = free;
    if (w.half_width < 0.6 * w.half_height) return {};
    const double slender = w.half_length / thickness_;
    const double area = 4 * w.half_width * w.half_height / (size_ * size_);
    return Found<impl::Window>{1 - rho + 0.7 * area - slender, w};
  }

  /// A bridge to the opposite face of a narrow valley.
  std::optional<Found<impl::Bridge>> across_gap(const SurfaceSample& face) const {
    const Vec3d outward = normalized(Vec3d{to_double(face.normal).x, to_double(face.normal).y, 0});
    const Vec3d start = face.position + outward * (2 * step_);
    const double gap = until(true, start, outward, span_);
    if (gap < 0.3 * size_ || solid(start)) return {};
    const Vec3d other = start + outward * (gap + step_);
    if (!ground_.usable(other, 0.5 * size_)) return {};
    const Vec3d middle = 0.5 * (face.position + other);
    const double drop = until(true, middle, {0, 0, -1}, 6 * size_);
    if (drop > 0 && drop < 0.6 * size_) return {};
    // High up, but below the rims on both sides.
    for (Vec3d end : {face.position, other}) {
      const Vec3d in = end + (end == other ? outward : -outward) * (0.12 * gap);
      if (!solid(in) || !solid(in + Vec3d{0, 0, 0.15 * size_})) return {};
    }
    const double up = until(false, face.position - outward * (3 * step_), {0, 0, 1}, 2 * size_);
    if (up < 0) return {};
    return Found<impl::Bridge>{gap / span_ - up / size_, bridge(face.position, other)};
  }

  // --- Building ---

  impl::RockTexture texture(double sign) const {
    impl::RockTexture t;
    t.geology = ground_.site().geology;
    t.relief = sign * 0.22 * p_.weakness * size_ * 0.6;
    t.unevenness = 0.05 * p_.roughness * size_;
    t.wavelength = 0.5 * size_;
    t.amplitude = ground_.site().amplitude;
    t.origin = ground_.site().origin;
    t.seed = hash_combine(ground_.site().seed, Stream::rock);
    return t;
  }

  impl::Bridge bridge(Vec3d a, Vec3d b) const {
    const double span = length(b - a);
    Random random(hash_combine(ground_.site().seed, Stream::bridges),
                  static_cast<std::uint64_t>(bridges_.size()));
    return {a,
            b,
            0.12 * span,
            std::max(1.5, 0.08 * span),
            std::max(1.2, 0.055 * span),
            0.08 * span * random.uniform(-1, 1) * p_.roughness};
  }

  void user_bridges() {
    const auto& points = ground_.site().points;
    for (std::size_t i = 0; i + 1 < points.size(); i += 2)
      if (ground_.usable(points[i]) && ground_.usable(points[i + 1]) && length(points[i + 1] - points[i]) > 1)
        build(bridge(points[i], points[i + 1]));
  }

  void build(const impl::Bridge& b) {
    const auto shape = impl::bridge_shape(b, texture(1));
    bridges_.push_back(field::function(shape));
    places_.push_back(0.5 * (b.from + b.to) + Vec3d{0, 0, b.rise});
    reached_.expand(impl::reach(b, shape->margin(), ground_.site().amplitude));
  }

  template <class T>
  static void best_first(std::vector<Found<T>>& found) {
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.merit > b.merit; });
  }

  void take_windows(std::vector<Found<impl::Window>>& found) {
    best_first(found);
    for (auto& [merit, w] : found) {
      progress_.check();
      if (std::ssize(windows_) >= p_.count) return;
      if (taken_->any_near(w.center, 2 * size_) || !inside(w)) continue;
      for (int attempt = 0; attempt < 3; ++attempt, w.half_width *= 0.8, w.half_height *= 0.85) {
        const auto shape = impl::window_shape(w, texture(-1));
        if (!sound(w, *shape)) continue;
        taken_->insert(w.center);
        windows_.push_back(field::function(shape));
        places_.push_back(w.center);
        heights_.push_back(2 * w.half_height);
        reached_.expand(impl::reach(w, shape->margin(), ground_.site().amplitude));
        break;
      }
    }
  }

  void take_bridges(std::vector<Found<impl::Bridge>>& found) {
    best_first(found);
    const std::size_t most = bridges_.size() + static_cast<std::size_t>(p_.bridges);
    for (const auto& [merit, b] : found) {
      if (bridges_.size() >= most) return;
      const Vec3d middle = 0.5 * (b.from + b.to);
      if (taken_->any_near(middle, 2 * size_)) continue;
      taken_->insert(middle);
      build(b);
    }
  }

  /// Its corners lie on real data and in the region.
  bool inside(const impl::Window& w) const {
    const Vec3d u = w.along() * w.half_width, d = w.through * w.half_length;
    for (double z : {-0.9, 0.9})
      for (const Vec3d& c : {u + d, u - d, d - u, -u - d})
        if (!ground_.usable(w.center + c + Vec3d{0, 0, z * w.half_height})) return false;
    return true;
  }

  /// Air all the way through; above it, rock for the thickness of the roof from pier to pier; piers.
  bool sound(const impl::Window& w, const impl::RockShape& shape) const {
    std::vector<Vec3d> way, rock;
    const double end = w.shaft_radius > 0 ? w.shaft_at : w.half_length;
    for (double t = -w.half_length; t <= end; t += step_) way.push_back(w.center + w.through * t);
    if (w.shaft_radius > 0)
      for (double z = 0; z < w.shaft_top; z += step_)
        way.push_back(w.center + w.through * w.shaft_at + Vec3d{0, 0, z});
    std::vector<float> before(way.size()), opening(way.size());
    field_.values(way, before);
    shape.values(way, opening);
    for (std::size_t i = 0; i < way.size(); ++i)
      if (before[i] > 0 && opening[i] <= 0) return false;
    const Vec3d crown = w.center - (w.shaft_radius > 0 ? w.through * (0.25 * w.half_length) : Vec3d{});
    for (double s = -1.35; s <= 1.36; s += 0.15)
      for (double z = 0.3; z <= 0.95; z += 0.2) {
        const Vec3d above{0, 0, w.half_height + shape.margin() + z * roof_};
        if (std::abs(s) < 1.2)
          rock.push_back(crown + w.along() * (s * w.half_width) + above);
        else
          rock.push_back(crown + w.along() * (s * w.half_width) + Vec3d{0, 0, z * w.half_height});
      }
    if (w.shaft_radius > 0) skin(w, shape.margin(), rock);
    std::vector<float> remains(rock.size()), gone(rock.size());
    field_.values(rock, remains);
    shape.values(rock, gone);
    for (std::size_t i = 0; i < rock.size(); ++i)
      if (remains[i] <= 0 || gone[i] >= 0) return false;
    return true;
  }

  /// Places around a shaft, from the roof of its window to the ground about it, which must stay rock.
  void skin(const impl::Window& w, double margin, std::vector<Vec3d>& rock) const {
    const Vec3d axis = w.center + w.through * w.shaft_at;
    const double top = w.shaft_top - 0.5 * size_ - 0.15 * size_;
    const double around = 1.2 * w.shaft_radius + margin;
    for (double z = w.half_height + margin + 0.5 * roof_; z < top; z += 2 * step_)
      for (const Vec3d& d : {-w.through, w.along(), -w.along()})
        rock.push_back(axis + d * around + Vec3d{0, 0, z});
  }

  Result finish() const {
    Result result;
    result.facts.count("arches", std::ssize(windows_))
        .count("bridges", std::ssize(bridges_))
        .places("positions", places_)
        .lengths("opening_heights", heights_)
        .count("primitives", 0);
    if (windows_.empty() && bridges_.empty()) return result;
    result.reshaped = reached_;
    result.reshape = [windows = windows_, bridges = bridges_](field::NodePtr tree) {
      if (!bridges.empty()) {
        std::vector<field::NodePtr> all = {std::move(tree)};
        all.insert(all.end(), bridges.begin(), bridges.end());
        tree = field::unite(std::move(all));
      }
      if (windows.empty()) return tree;
      return field::subtract(tree, field::unite(windows));
    };
    return result;
  }

  const Params& p_;
  Ground ground_;
  field::CompiledField field_;
  Progress& progress_;
  double size_, thickness_, roof_, span_, step_;
  std::optional<SpatialHash> taken_;
  std::vector<field::NodePtr> windows_, bridges_;
  std::vector<Vec3d> places_;
  std::vector<double> heights_;
  Box3d reached_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "arch");
  return Arches(site, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "arch",
                .doc = "Arches through fins, ridges and cliff rims, natural bridges across canyons and "
                       "between given points",
                .source = "[Paris19 §5.2, §6.1, figs. 8, 23]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_arch
