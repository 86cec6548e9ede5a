#include "tafoni/terrain/impl/valleys.h"

#include <numbers>

#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/terrain/impl/spread.h"

namespace tafoni::terrain::impl {
namespace {

constexpr double pi = std::numbers::pi;

enum class ValleysStream : std::uint64_t { course = 31, widths = 32, sides = 33 };

/// Chosen by eye, so that rivers look like rivers and side valleys leave room for ridges.
namespace valleys_look {
constexpr double margin = 0.12;      // of the map's lesser side: how far rivers are followed beyond its edge
constexpr double patience = 0.4;     // of a wavelength: how long a river keeps straying to one side
constexpr double unevenness = 0.35;  // share by which meanders differ in length
constexpr double swelling = 0.25;    // share by which a river's width rises and falls …
constexpr double swell_rate = 2.6;   // … so many half waves in a wavelength of its course
constexpr double most_sides = 400;   // side valleys of one river
constexpr double least_angle = 0.75, greatest_angle = 1.35;  // radians between a side valley and its river
constexpr double stunted = 0.6;      // of the least length: shorter valleys are left out, …
constexpr double cramped = 1.5;      // … and those shorter than this many times the distance kept
constexpr double fall_share = 0.7;   // share of the bed's rise that falls make
constexpr double fall_run = 0.25;    // share of the way from fall to fall that a fall takes
constexpr double mouth_share = 0.7;  // a side valley's greatest width, as a share of its river's
}  // namespace valleys_look

Vec2d heading_vector(double heading) {
  return {std::cos(heading), std::sin(heading)};
}

double distance(Vec2d a, Vec2d b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

Valleys::Valleys(Vec2d extent, double step, std::uint64_t seed)
    : extent_(extent),
      step_(step),
      margin_(valleys_look::margin * std::min(extent.x, extent.y)),
      cell_size_(std::max(10 * step, 0.02 * std::min(extent.x, extent.y))),
      seed_(seed) {}

bool Valleys::on_map(Vec2d p) const {
  return p.x > -margin_ && p.y > -margin_ && p.x < extent_.x + margin_ && p.y < extent_.y + margin_;
}

River Valleys::walk(RiverPoint from, double heading, double length, const Winding& winding,
                    Random random) const {
  River river;
  const double phase = random.uniform(0, 2 * pi);
  double stray = 0, drift = 0, turn = 0;
  const double patience = valleys_look::patience * winding.wavelength;
  for (double s = 0; s < length; s += step_) {
    from.along = s;
    river.push_back(from);
    // A bounded random walk of the direction, and meanders of uneven length.
    drift += (random.uniform(-1, 1) * std::sqrt(step_ / patience) - drift * step_ / patience);
    stray += (winding.wander * drift - stray) * std::min(1.0, step_ / patience);
    turn += 2 * pi * step_ / winding.wavelength * (1 + valleys_look::unevenness * drift);
    const double way = heading + stray + winding.swing * std::sin(turn + phase);
    from.position = from.position + heading_vector(way) * step_;
  }
  return river;
}

void Valleys::add_main(double middle, double bed, double gradient, double half_width, const Winding& winding,
                       bool to_north) {
  const double across = to_north ? extent_.x : extent_.y, along = to_north ? extent_.y : extent_.x;
  const double heading = to_north ? pi / 2 : pi;
  RiverPoint mouth{{0, 0}, bed, half_width};
  River river =
      walk(mouth, heading, 4 * (along + 2 * margin_), winding, Random(seed_, ValleysStream::course));
  // Cut where it has crossed the map, then put in its place.
  const auto progress = [&](Vec2d p) { return to_north ? p.y : -p.x; };
  std::size_t end = 0;
  while (end + 1 < river.size() && progress(river[end].position) < along + 2 * margin_) ++end;
  river.resize(end + 1);
  double mean = 0;
  for (const RiverPoint& p : river) mean += to_north ? p.position.x : p.position.y;
  mean /= static_cast<double>(river.size());
  const Vec2d shift =
      to_north ? Vec2d{middle * across - mean, -margin_} : Vec2d{extent_.x + margin_, middle * across - mean};
  Random random(seed_, ValleysStream::widths);
  const double phase = random.uniform(0, 2 * pi);
  for (RiverPoint& p : river) {
    p.position = p.position + shift;
    p.bed = bed + gradient * p.along;
    p.half_width =
        half_width * (1 + valleys_look::swelling *
                              std::sin(phase + valleys_look::swell_rate * p.along / winding.wavelength * pi));
  }
  rivers_.push_back(std::move(river));
  occupy(rivers_.size() - 1);
}

std::uint64_t Valleys::cell(Vec2d p, int dx, int dy) const {
  const auto x = floor_to<std::int64_t>(p.x / cell_size_) + dx;
  const auto y = floor_to<std::int64_t>(p.y / cell_size_) + dy;
  return x * 0x100000001ull ^ y;
}

void Valleys::occupy(std::size_t river) {
  // A point every quarter of a cell will do.
  const auto stride = floor_to(std::max(1.0, 0.25 * cell_size_ / step_));
  for (std::size_t i = 0; i < rivers_[river].size(); i += stride)
    visits_[cell(rivers_[river][i].position, 0, 0)].push_back(
        {static_cast<std::uint32_t>(river), static_cast<std::uint32_t>(i)});
}

bool Valleys::crowded(Vec2d p, double apart, std::size_t parent, Vec2d mouth) const {
  const int n = std::clamp(ceil_to(apart / cell_size_), 1, 8);
  for (int dy = -n; dy <= n; ++dy)
    for (int dx = -n; dx <= n; ++dx) {
      const auto found = visits_.find(cell(p, dx, dy));
      if (found == visits_.end()) continue;
      for (const Visit& visit : found->second) {
        const Vec2d other = rivers_[visit.river][visit.point].position;
        const bool home = visit.river == parent && distance(p, mouth) < 2 * apart;
        if (!home && distance(p, other) < apart) return true;
      }
    }
  return false;
}

/// Gives a side valley its bed and its widths. Falls break the bed's even rise; between them it is gentler.
void shape_side(River& side, const SideValleys& sides, const RiverPoint& mouth, std::uint64_t seed) {
  const double reached = side.back().along;
  Random random(seed);
  const double start = random.uniform(0, 1);
  for (RiverPoint& p : side) {
    const double t = p.along / reached;
    double rise = std::pow(t, sides.steepening);
    if (sides.falls > 0) {
      const double turns = rise * sides.falls + start, step = std::floor(turns);
      const double fall =
          smoothstep(0.0, valleys_look::fall_run, turns - step - (1 - valleys_look::fall_run));
      const double stepped = (step + fall - start) / sides.falls;
      // Mouth and head are left as they are.
      rise += valleys_look::fall_share * smoothstep(0.0, 0.25, t) * smoothstep(0.0, 0.25, 1 - t) *
              (stepped - rise);
    }
    p.bed = mouth.bed + std::max(0.0, rise) * std::max(0.0, sides.head - mouth.bed);
    const double least = std::min(sides.half_width[0], valleys_look::mouth_share * mouth.half_width);
    p.half_width = least + (std::min(sides.half_width[1], least) - least) * std::sqrt(t);
  }
}

River Valleys::side_valley(const SideValleys& sides, std::size_t parent, int i, int wanted, double hand,
                           Random& random) const {
  const River& river = rivers_[parent];
  const double at = (i + random.uniform(0.1, 0.9)) / wanted * static_cast<double>(river.size() - 1);
  const double angle = random.uniform(valleys_look::least_angle, valleys_look::greatest_angle),
               length = random.uniform(sides.length[0], sides.length[1]);
  const std::uint64_t own = random.next();
  if (river.size() < 4) return {};
  const std::size_t k = std::clamp<std::size_t>(floor_to(at), 1, river.size() - 1);
  const RiverPoint mouth = river[k];
  const Vec2d up = mouth.position - river[k > 6 ? k - 6 : 0].position;
  const double heading = std::atan2(up.y, up.x) + (i % 2 ? hand : -hand) * angle;
  River side = walk(mouth, heading, length, sides.winding, Random(seed_, own));
  std::size_t n = 0;
  while (n < side.size() && on_map(side[n].position) &&
         !crowded(side[n].position, sides.apart, parent, mouth.position))
    ++n;
  side.resize(n);
  const double reached = side.empty() ? 0 : side.back().along;
  if (reached < valleys_look::stunted * sides.length[0] || reached < valleys_look::cramped * sides.apart)
    return {};
  shape_side(side, sides, mouth, own);
  return side;
}

void Valleys::add_sides(const SideValleys& sides, int generation) {
  const std::size_t parents = rivers_.size();
  const auto key =
      hash_combine(static_cast<std::uint64_t>(ValleysStream::sides), static_cast<std::uint64_t>(generation));
  Random random(seed_, key);
  for (std::size_t parent = 0; parent < parents; ++parent) {
    const double whole = rivers_[parent].back().along;
    const int wanted = round_to(std::min(valleys_look::most_sides, sides.per_km * whole / 1000));
    const double hand = random.uniform() < 0.5 ? 1 : -1;
    for (int i = 0; i < wanted; ++i) {
      River side = side_valley(sides, parent, i, wanted, hand, random);
      if (side.empty()) continue;
      rivers_.push_back(std::move(side));
      occupy(rivers_.size() - 1);
    }
  }
}

ValleyMap::ValleyMap(const std::vector<River>& rivers, const Face& face, const raster::Placement& placement,
                     int width, int height)
    : placement_(placement), best_(width, height, -1) {
  for (const River& river : rivers)
    for (const RiverPoint& p : river) {
      points_.push_back(p);
      foot_.push_back(face.reach(p.bed) - p.half_width);
    }
  const auto cost = [this](int col, int row, std::int32_t i) {
    return foot_[i] + distance(points_[i].position, placement_.center(col, row));
  };
  Spread spread(best_, cost);
  for (std::int32_t i = 0; i < std::ssize(points_); ++i) {
    // Points beyond the edge reach in by way of the nearest cell.
    const Vec2d at = placement_.pixel(points_[i].position.x, points_[i].position.y);
    spread.offer(round_to(std::clamp(at.x, 0.0, width - 1.0)), round_to(std::clamp(at.y, 0.0, height - 1.0)),
                 i);
  }
  spread.run();
}

ValleyMap::Place ValleyMap::at(Vec2d p) const {
  const Vec2d pixel = placement_.pixel(p.x, p.y);
  const int col = round_to(std::clamp(pixel.x, 0.0, best_.width() - 1.0));
  const int row = round_to(std::clamp(pixel.y, 0.0, best_.height() - 1.0));
  const std::int32_t i = best_.at(col, row);
  const double d = distance(points_[i].position, p), half = points_[i].half_width;
  return {foot_[i] + std::max(d, half), d - half, &points_[i]};
}

}  // namespace tafoni::terrain::impl
