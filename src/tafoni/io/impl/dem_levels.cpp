// Windows are averaged down by strips. An overview saves reading most of a large file; but overviews may hold
// every n-th pixel, or marks of missing data mixed into heights, so it is compared with the file's own pixels
// in a few places, and where it is off the pixels themselves are read.

#include "tafoni/io/impl/dem_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tafoni/math/whole.h"

namespace tafoni::io::impl {
namespace {

/// An overview serves although rounding made it so much smaller than the size asked for.
constexpr double overview_share = 0.999;

/// The share of a pixel of an average that must be known, and the part by which rounding may make it less.
constexpr double known_share = 0.5, known_rounding = 1e-6;

/// Pixels read at once: 16 MB of doubles.
constexpr int strip_pixels = 1 << 21;

/// Pixels of a window that are read in less than a second: no overview is needed.
constexpr double soon_read = 1 << 24;
/// Places a side that are compared, and pixels of the overview a side in each: few beside what they stand
/// for.
constexpr int places_aside = 4, place_pixels = 4;
/// Cells a side of the window, in each of which the pixel is compared that sticks out most.
constexpr int suspect_cells = 6;
/// How far area averages may be off the pixels' own, as a share of what the pixels vary by within one of the
/// overview's: rounding, or a filter that is wider than a pixel. Every n-th pixel is off by about 1.
constexpr double average_off = 0.1;
/// How far beyond the range of its pixels one of the overview may lie, as a share of that range.
constexpr double beyond_range = 0.5;
/// Steps of whole numbers by which averages of averages are rounded.
constexpr double rounding_steps = 1.5;

/// Spreads the rows of a level over the rows of the target, by area.
class Averager {
 public:
  Averager(raster::Grid<float>& out, double fx, double fy)
      : out_(out), fx_(fx), fy_(fy), sums_(2 * columns()), weights_(2 * columns()) {}

  /// A source row whose pixel i spans [left + i * wide, … + wide) and [top, bottom), in the file's pixels
  /// from the window's corner. Rows come from the top down.
  void add(const double* values, int count, double left, double wide, double top, double bottom) {
    top = std::max(top, 0.0);
    while (top < bottom && row_ < out_.height()) {
      const double end = (row_ + 1) * fy_;
      const double tall = std::min(bottom, end) - top;
      if (tall > 0) spread(values, count, left, wide, tall);
      if (bottom < end) return;
      finish_row();
      top = std::max(top, end);
    }
  }
  void finish() {
    while (row_ < out_.height()) finish_row();
  }

 private:
  int columns() const { return out_.width(); }
  void spread(const double* values, int count, double left, double wide, double tall) {
    for (int i = 0; i < count; ++i) {
      if (std::isnan(values[i])) continue;
      const double begin = std::max(left + i * wide, 0.0), end = left + (i + 1) * wide;
      for (int col = static_cast<int>(begin / fx_); col < out_.width() && col * fx_ < end; ++col) {
        const double weight = (std::min(end, (col + 1) * fx_) - std::max(begin, col * fx_)) * tall;
        if (weight <= 0) continue;
        sums_[col] += weight * values[i];
        weights_[col] += weight;
      }
    }
  }
  void finish_row() {
    for (int col = 0; col < out_.width(); ++col) {
      if (weights_[col] > known_share * fx_ * fy_ * (1 - known_rounding))
        out_.at(col, row_) = static_cast<float>(sums_[col] / weights_[col]);
    }
    std::fill(sums_.begin(), sums_.end(), 0.0);
    std::fill(weights_.begin(), weights_.end(), 0.0);
    ++row_;
  }

  raster::Grid<float>& out_;
  double fx_, fy_;
  std::vector<double> sums_, weights_;
  int row_ = 0;
};

/// A strip of blocks of a level, or of a part of them.
struct Patch {
  int x, y, width, height;
  std::vector<double> heights;
};

Patch patch_of(DemSource& source, std::size_t level, int x, int y, int right, int bottom) {
  Patch patch{x, y, right - x, bottom - y, {}};
  patch.heights.resize(std::int64_t{patch.width} * patch.height);
  source.read(level, x, y, patch.width, patch.height, patch.heights.data());
  return patch;
}

/// What the file's own pixels say of one pixel of an overview.
struct Block {
  double weight = 0, sum = 0, squares = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool whole = true;  ///< none of its pixels is missing

  double mean() const { return sum / weight; }
  double variance() const { return std::max(0.0, squares / weight - mean() * mean()); }
};

Block block_of(const Patch& own, double left, double top, double right, double bottom) {
  Block out;
  for (int row = 0; row < own.height; ++row)
    for (int col = 0; col < own.width; ++col) {
      const double x = own.x + col, y = own.y + row;
      const double weight = std::max(0.0, std::min(right, x + 1) - std::max(left, x)) *
                            std::max(0.0, std::min(bottom, y + 1) - std::max(top, y));
      if (weight <= 0) continue;
      const double v = own.heights[std::int64_t{row} * own.width + col];
      if (std::isnan(v)) {
        out.whole = false;
        continue;
      }
      out.weight += weight;
      out.sum += weight * v;
      out.squares += weight * v * v;
      out.low = std::min(out.low, v);
      out.high = std::max(out.high, v);
    }
  return out;
}

/// Compares an overview with the file's own pixels in places.
class Comparison {
 public:
  Comparison(DemSource& source, std::size_t level)
      : source_(source),
        level_(level),
        wide_(1.0 * source.width() / source.levels[level].width),
        tall_(1.0 * source.height() / source.levels[level].height) {}

  /// Looks at the pixels [x, right) and [y, bottom) of the overview.
  void add(int x, int y, int right, int bottom) {
    const Patch coarse = patch_of(source_, level_, x, y, right, bottom);
    const Patch own = patch_of(source_, 0, floor_to(x * wide_), floor_to(y * tall_),
                               std::min(source_.width(), ceil_to(right * wide_)),
                               std::min(source_.height(), ceil_to(bottom * tall_)));
    for (int row = 0; row < coarse.height; ++row)
      for (int col = 0; col < coarse.width; ++col)
        compare(coarse.heights[std::int64_t{row} * coarse.width + col],
                block_of(own, (x + col) * wide_, (y + row) * tall_, (x + col + 1) * wide_,
                         (y + row + 1) * tall_));
  }

  /// Metres by which the overview is off; 0 where it holds area averages.
  double off() const {
    const double rounding = rounding_steps * source_.step();
    const double mean = count_ > 0 ? std::sqrt(squares_ / count_) : 0;
    const double allowed = count_ > 0 ? average_off * std::sqrt(spread_ / count_) : 0;
    return std::max(worst_, mean > allowed + rounding ? mean : 0);
  }

 private:
  void compare(double coarse, const Block& own) {
    if (std::isnan(coarse)) {
      if (own.whole) worst_ = std::max(worst_, std::max(own.high - own.low, 1.0));
      return;
    }
    if (own.weight == 0) {
      worst_ = std::max(worst_, std::abs(coarse));
      return;
    }
    const double room = beyond_range * (own.high - own.low) + rounding_steps * source_.step() +
                        1e-5 * std::max(std::abs(own.low), std::abs(own.high));
    const double outside = std::max(own.low - coarse, coarse - own.high);
    if (outside > room) worst_ = std::max(worst_, outside);
    if (!own.whole) return;
    squares_ += (coarse - own.mean()) * (coarse - own.mean());
    spread_ += own.variance();
    ++count_;
  }

  DemSource& source_;
  std::size_t level_;
  double wide_, tall_;
  double squares_ = 0, spread_ = 0, worst_ = 0;
  double count_ = 0;
};

/// In each cell of a window the pixel that differs most from those before it: where something that is no
/// height was mixed in, it shows there.
class Suspects {
 public:
  Suspects(int left, int top, int width, int height)
      : left_(left), top_(top), width_(width), height_(height), above_(width, 0) {}

  /// Rows come from the top down.
  void add(const double* values, int row) {
    for (int col = 0; col < width_; ++col) {
      const double across = col > 0 ? std::abs(values[col] - values[col - 1]) : 0;
      const double down = row > top_ ? std::abs(values[col] - above_[col]) : 0;
      const double out = (across > 0 ? across : 0) + (down > 0 ? down : 0);
      Suspect& worst = found_[std::int64_t{row - top_} * suspect_cells / height_ * suspect_cells +
                              std::int64_t{col} * suspect_cells / width_];
      if (out > worst.out) worst = {out, left_ + col, row};
    }
    std::copy(values, values + width_, above_.begin());
  }

  void show(Comparison& to) const {
    for (const Suspect& s : found_)
      if (s.out > 0) to.add(s.col, s.row, s.col + 1, s.row + 1);
  }

 private:
  struct Suspect {
    double out = 0;
    int col = 0, row = 0;
  };
  int left_, top_, width_, height_;
  std::vector<double> above_;
  std::array<Suspect, suspect_cells * suspect_cells> found_{};
};

/// A window of a level, in its pixels.
struct LevelWindow {
  double wide, tall;  ///< of the file's own pixels
  int left, top, right, bottom;
};

LevelWindow on_level(const DemSource& source, std::size_t level, const std::array<int, 4>& window) {
  const Level& from = source.levels[level];
  const double wide = 1.0 * source.width() / from.width, tall = 1.0 * source.height() / from.height;
  const auto [x, y, w, h] = window;
  return {wide,
          tall,
          floor_to(x / wide),
          floor_to(y / tall),
          std::min(from.width, ceil_to((x + w) / wide)),
          std::min(from.height, ceil_to((y + h) / tall))};
}

/// The coarsest level that is fine enough for pixels of fx by fy.
std::size_t level_for(const DemSource& source, double fx, double fy) {
  std::size_t level = 0;
  for (std::size_t i = 1; i < source.levels.size(); ++i) {
    const Level& coarse = source.levels[i];
    if (coarse.width * fx >= source.width() * overview_share &&
        coarse.height * fy >= source.height() * overview_share)
      level = i;
  }
  return level;
}

/// Compares places that are spread evenly over a window.
void compare_evenly(Comparison& to, const LevelWindow& window, Progress& progress) {
  const auto first = [](int begin, int end, int i) {
    return begin + (end - begin) * (2 * i + 1) / (2 * places_aside);
  };
  for (int row = 0; row < places_aside; ++row)
    for (int col = 0; col < places_aside; ++col) {
      progress.check();
      const int x = first(window.left, window.right, col), y = first(window.top, window.bottom, row);
      to.add(x, y, std::min(x + place_pixels, window.right), std::min(y + place_pixels, window.bottom));
    }
}

class LevelReader {
 public:
  LevelReader(DemSource& source, const std::array<int, 4>& window, double fx, double fy, Progress& progress)
      : source_(source), window_(window), fx_(fx), fy_(fy), progress_(progress) {}

  /// Averages a level into `out`, and shows each of its rows to `suspects`, if any.
  void read(std::size_t level, raster::Grid<float>& out, Suspects* suspects) {
    const Level& from = source_.levels[level];
    const LevelWindow on = on_level(source_, level, window_);
    const int columns = on.right - on.left;
    // A strip is whole blocks, or compressed ones would be unpacked again and again.
    const int blocks = std::max(1, strip_pixels / columns / from.block_height);
    const int most_rows = std::max(1, std::min(blocks * from.block_height, strip_pixels / columns));
    std::vector<double> strip;
    Averager averager(out, fx_, fy_);
    const bool plain = level == 0 && fx_ == 1 && fy_ == 1;
    progress_.begin("read", on.bottom - on.top, "rows");
    for (int row = on.top; row < on.bottom;) {
      int rows = std::min(most_rows, on.bottom - row);
      if (most_rows >= from.block_height && (row + rows) % from.block_height != 0 && row + rows < on.bottom)
        rows -= (row + rows) % from.block_height;
      strip.resize(std::int64_t{columns} * rows);
      source_.read(level, on.left, row, columns, rows, strip.data());
      for (int r = 0; r < rows; ++r) {
        const double* values = strip.data() + std::int64_t{r} * columns;
        if (suspects != nullptr) suspects->add(values, row + r);
        if (plain)
          std::transform(values, values + columns, out.row(row + r - on.top),
                         [](double v) { return static_cast<float>(v); });
        else
          averager.add(values, columns, on.left * on.wide - window_[0], on.wide,
                       (row + r) * on.tall - window_[1],
                       std::min<double>((row + r + 1) * on.tall - window_[1], window_[3]));
      }
      progress_.advance(rows);
      row += rows;
    }
    if (!plain) averager.finish();
    progress_.end();
  }

  /// Averages an overview into `out`; gives back how far it is off the file's own pixels, where `out` is
  /// void.
  double read_overview(std::size_t level, raster::Grid<float>& out) {
    const ReadReport before = source_.report;
    const LevelWindow on = on_level(source_, level, window_);
    Comparison comparison(source_, level);
    compare_evenly(comparison, on, progress_);
    source_.report = before;
    if (comparison.off() > 0) return comparison.off();
    Suspects suspects(on.left, on.top, on.right - on.left, on.bottom - on.top);
    read(level, out, &suspects);
    const ReadReport after = source_.report;
    suspects.show(comparison);
    source_.report = comparison.off() > 0 ? before : after;
    return comparison.off();
  }

 private:
  DemSource& source_;
  const std::array<int, 4>& window_;
  double fx_, fy_;
  Progress& progress_;
};

}  // namespace

Reading read_window(DemSource& source, const std::array<int, 4>& window, double fx, double fy, int width,
                    int height, Progress& progress) {
  Reading out{raster::Grid<float>(width, height, raster::no_data)};
  LevelReader reader(source, window, fx, fy, progress);
  const std::size_t level = 1.0 * window[2] * window[3] > soon_read ? level_for(source, fx, fy) : 0;
  if (level > 0) {
    out.overviews_off = reader.read_overview(level, out.heights);
    if (out.overviews_off == 0) return out;
    out.heights = raster::Grid<float>(width, height, raster::no_data);
  }
  reader.read(0, out.heights, nullptr);
  return out;
}

}  // namespace tafoni::io::impl
