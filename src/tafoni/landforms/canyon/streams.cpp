// Rivers: cells of great stream power over the filled terrain. Floods spread from them over lower flats, and
// three box means carry their stress, the bed's elevation and the flow's direction into the banks. Courses
// are traced upstream from where the most water leaves.

#include "tafoni/landforms/canyon/streams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "tafoni/core/parallel.h"
#include "tafoni/math/whole.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms::impl {
namespace {

constexpr int tile = 8;

/// Chosen by eye.
namespace streams_look {
// A sheer face outdoes any river by its slope, so that slopes are kept within these, and averaged over so
// many cells to each side.
constexpr float least_slope = 0.02f, greatest_slope = 0.35f;
constexpr int slope_mean = 2;
// Water spreads by this power of the slope among lower neighbours [Freeman91].
constexpr double freeman = 1.1;
// So many of the outermost cells are no river: along the map's edge runs water that ought to leave the map.
constexpr int rim = 3;
// Floods cover flats as far as so many times the banks; three means over a third of the banks each reach as
// far as the banks in all.
constexpr double covered = 3;
constexpr int means = 3;
// Courses of fewer cells are too short to count.
constexpr std::size_t least_course = 8;
}  // namespace streams_look

struct Pixel {
  int col, row;
};
Pixel pixel_of(std::ptrdiff_t cell, int width) {
  return {static_cast<int>(cell % width), static_cast<int>(cell / width)};
}

/// The cell that holds v, or the nearest.
inline int cell_of(double v, int cells) {
  return static_cast<int>(std::clamp(v, 0.0, cells - 1.0));
}

/// A number known where it is compiled, and one that is not; loops over the former are unrolled.
template <std::size_t n>
using Known = std::integral_constant<std::size_t, n>;

/// Memory of mean_along(), used again from call to call.
struct MeanScratch {
  std::vector<float> copy;
  std::vector<double> sum;
};

/// A box mean of `radius` steps to each side along `count` steps of `lanes` floats each, which lie `stride`
/// floats apart; beyond the ends stand zeros. Sums are double, as what is added and taken off again must
/// leave exactly nothing behind.
template <class Lanes>
void mean_along(float* data, int count, std::ptrdiff_t stride, Lanes lanes, int radius,
                MeanScratch& scratch) {
  scratch.copy.resize(count * lanes);
  scratch.sum.assign(lanes, 0);
  float* const copy = scratch.copy.data();
  double* const sum = scratch.sum.data();
  for (int i = 0; i < count; ++i) std::copy_n(data + i * stride, std::size_t{lanes}, copy + i * lanes);
  const auto add = [&](int i) {
    const float* const from = copy + i * lanes;
    for (std::size_t k = 0; k < lanes; ++k) sum[k] += from[k];
  };
  const float scale = 1 / static_cast<float>(2 * radius + 1);
  for (int i = 0; i < std::min(radius, count); ++i) add(i);
  for (int i = 0; i < count; ++i) {
    if (i + radius < count) add(i + radius);
    if (i > radius) {
      const float* const from = copy + (i - radius - 1) * lanes;
      for (std::size_t k = 0; k < lanes; ++k) sum[k] -= from[k];
    }
    float* const to = data + i * stride;
    for (std::size_t k = 0; k < lanes; ++k) to[k] = static_cast<float>(sum[k]) * scale;
  }
}

/// A box mean of `radius` cells along rows, then columns, over several channels at once; cells beyond the rim
/// count as 0.
template <std::size_t n>
void blur(raster::Grid<std::array<float, n>>& grid, int radius) {
  static_assert(sizeof(std::array<float, n>) == n * sizeof(float));
  parallel_blocks(grid.height(), 16, [&](int begin, int end) {
    MeanScratch scratch;
    for (int row = begin; row < end; ++row)
      mean_along(grid.row(row)->data(), grid.width(), n, Known<n>(), radius, scratch);
  });
  // Columns side by side share cache lines.
  constexpr int block = 16;
  const std::ptrdiff_t stride = std::ptrdiff_t{n} * grid.width();
  parallel_blocks(grid.width(), block, [&](int begin, int end) {
    MeanScratch scratch;
    float* const first = grid.data()[begin].data();
    if (end - begin == block)
      mean_along(first, grid.height(), stride, Known<block * n>(), radius, scratch);
    else
      mean_along(first, grid.height(), stride, n * (end - begin), radius, scratch);
  });
}

}  // namespace

Streams::Streams(const Ground& ground, const StreamSettings& settings, Progress& progress)
    : ground_(ground), settings_(settings) {
  filled_ = *ground.site().heights;
  if (ground.site().valid)
    for (std::size_t i = 0; i < filled_.values.size(); ++i)
      if (!ground.site().valid->data()[i]) filled_.values.data()[i] = raster::no_data;
  filled_.values = terrain::fill_depressions(filled_, {}, progress);
  area_ = terrain::drainage_area(filled_, streams_look::freeman, progress);
  stress_ = power(progress);
  spread();
}

/// Whether a cell is one of the outermost, along which water runs that ought to leave the map.
bool Streams::rim(int col, int row) const {
  for (int dr = -streams_look::rim; dr <= streams_look::rim; ++dr)
    for (int dc = -streams_look::rim; dc <= streams_look::rim; ++dc)
      if (!filled_.values.inside(col + dc, row + dr) || std::isnan(filled_.values.at(col + dc, row + dr)))
        return true;
  return false;
}

/// The stream power in the river's bed as a share of the greatest; 0 elsewhere.
raster::Grid<float> Streams::power(Progress& progress) {
  raster::Grid<float> slope = terrain::slope(filled_, progress);
  for (float& s : slope.values())
    s = std::isnan(s) ? 0 : std::clamp(s, streams_look::least_slope, streams_look::greatest_slope);
  raster::Grid<std::array<float, 1>> mean(slope.width(), slope.height());
  for (std::size_t i = 0; i < slope.size(); ++i) mean.data()[i] = {slope.data()[i]};
  blur(mean, streams_look::slope_mean);
  for (std::size_t i = 0; i < slope.size(); ++i) slope.data()[i] = mean.data()[i][0];
  raster::Grid<float> power = terrain::stream_power(area_, slope);
  const auto catchment = static_cast<float>(settings_.catchment),
             threshold = static_cast<float>(settings_.threshold);
  float greatest = 0;
  for (int row = 0; row < power.height(); ++row)
    for (int col = 0; col < power.width(); ++col) {
      const float area = area_.at(col, row);
      float& p = power.at(col, row);
      if (!(area >= catchment) || rim(col, row)) p = 0;
      greatest = std::max(greatest, p);
    }
  for (float& p : power.values()) {
    p = greatest > 0 ? p / greatest : 0;
    if (p < threshold) p = 0;
    cells_ += p > 0;
  }
  return power;
}

/// Water that rises above the bed covers the flats beside it: `stress` and `level`, the bed's elevation,
/// spread from the river's cells in the order of their distance.
void Streams::flood(raster::Grid<float>& stress, raster::Grid<float>& level) const {
  const int width = stress.width();
  const int steps = round_to(streams_look::covered * settings_.banks / ground_.pixel());
  const auto rise = static_cast<float>(settings_.flood);
  std::vector<std::ptrdiff_t> wet, next;
  for (std::ptrdiff_t i = 0; i < std::ssize(stress); ++i) {
    level.data()[i] = filled_.values.data()[i];
    if (stress.data()[i] > 0) wet.push_back(i);
  }
  for (int step = 0; step < steps && !wet.empty(); ++step) {
    next.clear();
    for (const std::ptrdiff_t cell : wet) {
      const auto [col, row] = pixel_of(cell, width);
      const float top = level.data()[cell] + rise;
      for (const auto& [dc, dr] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (!stress.inside(col + dc, row + dr)) continue;
        const std::ptrdiff_t other = stress.index(col + dc, row + dr);
        if (stress.data()[other] > 0 || !(filled_.values.data()[other] < top)) continue;
        stress.data()[other] = stress.data()[cell];
        level.data()[other] = level.data()[cell];
        next.push_back(other);
      }
    }
    wet.swap(next);
  }
}

/// Three box means of the covered ground, its stress, the bed's elevation and its flow. What banks feel is
/// their local mean, less and less towards the end of the floods' reach.
void Streams::spread() {
  const int width = stress_.width(), height = stress_.height();
  reach_ = raster::Grid<Reach>(width, height);
  tiles_ = raster::Grid<float>((width + tile - 1) / tile, (height + tile - 1) / tile,
                               -std::numeric_limits<float>::infinity());
  if (cells_ == 0) return;
  raster::Grid<float> stress = stress_, level(width, height);
  flood(stress, level);
  using Sums = std::array<float, 5>;  // bed, stress, elevation, flow
  raster::Grid<Sums> sums(width, height);
  for (int row = 0; row < height; ++row)
    for (int col = 0; col < width; ++col) {
      const float s = stress.at(col, row);
      if (!(s > 0)) continue;
      Sums& sum = sums.at(col, row);
      sum = {1, s, level.at(col, row), 0, 0};
      const std::ptrdiff_t cell = stress.index(col, row);
      const std::ptrdiff_t next = stress_.data()[cell] > 0 ? receiver(cell) : -1;
      if (next < 0) continue;
      const Pixel to = pixel_of(next, width);
      const auto east = static_cast<float>(to.col - col), north = static_cast<float>(row - to.row);
      const float norm = std::sqrt(east * east + north * north);
      sum[3] = east / norm;
      sum[4] = north / norm;
    }
  const int radius = std::max(1, round_to(settings_.banks / (streams_look::means * ground_.pixel())));
  for (int i = 0; i < streams_look::means; ++i) blur(sums, radius);
  // A bed one cell wide covers about this much at its middle.
  const float middle = 0.5f / static_cast<float>(2 * radius + 1);
  for (int row = 0; row < height; ++row)
    for (int col = 0; col < width; ++col) {
      const Sums& s = sums.at(col, row);
      // Rounding of sums taken apart again leaves specks.
      if (!(s[0] > 1e-3f * middle)) continue;
      const float covered = std::min(1.0f, s[0] / middle);
      const float flow = std::hypot(s[3], s[4]);
      reach_.at(col, row) = {covered * s[1] / s[0], s[2] / s[0], flow > 0 ? s[3] / flow : 0,
                             flow > 0 ? s[4] / flow : 0};
      float& highest = tiles_.at(col / tile, row / tile);
      highest = std::max(highest, reach_.at(col, row).bed);
    }
}

Streams::Bank Streams::at(Vec3d p) const {
  const Vec2d at = filled_.placement.pixel(p.x, p.y);
  const Reach& r = reach_.at(cell_of(at.x + 0.5, reach_.width()), cell_of(at.y + 0.5, reach_.height()));
  return {r.stress, r.bed, {r.flow_x, r.flow_y}};
}

bool Streams::near(Vec3d p, double around, double height) const {
  const auto low = static_cast<float>(p.z - around - height);
  const Vec2d a = filled_.placement.pixel(p.x - around, p.y + around);
  const Vec2d b = filled_.placement.pixel(p.x + around, p.y - around);
  const auto index = [](double v, int count) { return cell_of((v + 0.5) / tile, count); };
  for (int row = index(a.y, tiles_.height()); row <= index(b.y, tiles_.height()); ++row)
    for (int col = index(a.x, tiles_.width()); col <= index(b.x, tiles_.width()); ++col)
      if (tiles_.at(col, row) > low) return true;
  return false;
}

/// The neighbour to which the ground falls most steeply; -1 where water leaves the map.
std::ptrdiff_t Streams::receiver(std::ptrdiff_t cell) const {
  const auto [col, row] = pixel_of(cell, filled_.width());
  const float h = filled_.values.data()[cell];
  std::ptrdiff_t best = -1;
  float steepest = 0;
  for (int dr = -1; dr <= 1; ++dr)
    for (int dc = -1; dc <= 1; ++dc) {
      if (!filled_.values.inside(col + dc, row + dr)) continue;
      const float drop = (h - filled_.values.at(col + dc, row + dr)) / (dr != 0 && dc != 0 ? 1.4142f : 1.0f);
      if (!(drop > steepest)) continue;
      steepest = drop;
      best = filled_.values.index(col + dc, row + dr);
    }
  return best;
}

/// Follows the greatest area upstream and marks the cells on and beside the course as taken.
Streams::Course Streams::trace(std::ptrdiff_t mouth, std::vector<bool>& taken) const {
  Course course;
  const auto catchment = static_cast<float>(settings_.catchment);
  for (std::ptrdiff_t cell = mouth; cell >= 0;) {
    const auto [col, row] = pixel_of(cell, filled_.width());
    const Vec2d at = filled_.placement.center(col, row);
    course.line.push_back({at.x, at.y, filled_.values.data()[cell]});
    course.stress.push_back(stress_.data()[cell]);
    std::ptrdiff_t next = -1;
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        if (!filled_.values.inside(col + dc, row + dr)) continue;
        const std::ptrdiff_t other = filled_.values.index(col + dc, row + dr);
        if (other == cell || taken[other] || !(filled_.values.data()[other] > filled_.values.data()[cell]) ||
            !(area_.data()[other] >= catchment))
          continue;
        if (next < 0 || area_.data()[other] > area_.data()[next]) next = other;
      }
    taken[cell] = true;
    cell = next;
  }
  // The rest of a broad bed is no course of its own.
  const int beside = round_to(settings_.banks / ground_.pixel());
  for (const Vec3d& p : course.line) {
    const Vec2d at = filled_.placement.pixel(p.x, p.y);
    const int col = round_to(at.x), row = round_to(at.y);
    for (int dr = -beside; dr <= beside; ++dr)
      for (int dc = -beside; dc <= beside; ++dc)
        if (dr * dr + dc * dc <= beside * beside && filled_.values.inside(col + dc, row + dr))
          taken[filled_.values.index(col + dc, row + dr)] = true;
  }
  return course;
}

std::vector<Streams::Course> Streams::courses(std::size_t count) const {
  std::vector<Course> out;
  std::vector<bool> taken(area_.size());
  const int width = area_.width();
  // Courses too short to count are passed over, but not for ever.
  for (std::size_t tries = 0; out.size() < count && tries < 4 * count + 16; ++tries) {
    // A course's mouth is where the most water leaves the river bed's cells for the map's rim or for a course
    // already there.
    std::ptrdiff_t mouth = -1;
    for (std::ptrdiff_t i = 0; i < std::ssize(area_); ++i) {
      if (taken[i] || !(stress_.data()[i] > 0)) continue;
      if (mouth >= 0 && area_.data()[i] <= area_.data()[mouth]) continue;
      const Pixel pixel = pixel_of(i, width);
      const Vec2d at = filled_.placement.center(pixel.col, pixel.row);
      if (!ground_.usable({at.x, at.y, filled_.values.data()[i]})) continue;
      mouth = i;
    }
    if (mouth < 0) break;
    // Where a bed is broad the most water may run in one cell far upstream: the mouth is down from there.
    for (std::ptrdiff_t next = mouth; next >= 0 && !taken[next]; next = receiver(next)) mouth = next;
    Course course = trace(mouth, taken);
    if (course.line.size() >= streams_look::least_course) out.push_back(std::move(course));
  }
  return out;
}

}  // namespace tafoni::landforms::impl
