// The layers of a prism-field: tiles of columns shared between copies until one is edited, and how a
// tool's span cuts, splits, joins and fills the matter of each column [Boggus §3].

#include "tafoni/volume/prism_field.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/math/whole.h"
#include "tafoni/volume/impl/tool_shape.h"

namespace tafoni::volume {

namespace {

constexpr int tile_side = PrismFields::tile_columns;
constexpr int tile_size = tile_side * tile_side;

/// Steps from a column to those beside it.
constexpr int beside[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

}  // namespace

/// A point is active where bottom < top.
struct PrismFields::Tile {
  float bottom[tile_size] = {}, top[tile_size] = {};
  int active = 0;
};

void ColumnBox::expand(int i, int j) {
  expand(ColumnBox{i, j, i, j});
}

void ColumnBox::expand(const ColumnBox& box) {
  if (box.empty()) return;
  if (empty()) {
    *this = box;
    return;
  }
  i0 = std::min(i0, box.i0), j0 = std::min(j0, box.j0);
  i1 = std::max(i1, box.i1), j1 = std::max(j1, box.j1);
}

PrismFields::PrismFields(const ColumnFrame& frame, double min_thickness)
    : frame_(frame),
      thinnest_(static_cast<float>(min_thickness)),
      tiles_x_((frame.nx + tile_side - 1) / tile_side),
      tiles_y_((frame.ny + tile_side - 1) / tile_side) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (frame.nx < 2 || frame.ny < 2 || std::int64_t{frame.nx} * frame.ny > (std::int64_t{1} << 31))
    fail(ErrorKind::usage, "a prism-field of {} x {} columns cannot be; give 2 to 46340 a side", frame.nx,
         frame.ny);
  if (!positive(frame.dx) || !positive(frame.dy) || !Box3d{frame.origin, frame.origin}.bounded())
    fail(ErrorKind::usage, "a prism-field's spacing of {} x {} m cannot be; give metres above 0", frame.dx,
         frame.dy);
  if (!positive(min_thickness))
    fail(ErrorKind::usage, "a prism-field's least thickness of {} m cannot be; give metres above 0",
         min_thickness);
}

PrismFields::Place PrismFields::place(int i, int j) const {
  const std::size_t tile = std::int64_t{j / tile_side} * tiles_x_ + i / tile_side,
                    at = j % tile_side * tile_side + i % tile_side;
  return {tile, at};
}

bool PrismFields::active(int layer, int i, int j) const {
  const Matter p = point(layer, i, j);
  return p.bottom < p.top;
}

Matter PrismFields::point(int layer, int i, int j) const {
  const Place p = place(i, j);
  const Tile* t = tile(layer, p.tile);
  return t ? Matter{t->bottom[p.at], t->top[p.at]} : Matter{};
}

void PrismFields::set(int layer, Place p, float bottom, float top) {
  Layer& l = layers_[layer];
  std::shared_ptr<Tile>& held = l.tiles[p.tile];
  const bool now = bottom < top;
  if (!held) {
    if (!now) return;
    held = std::make_shared<Tile>();
  } else if (held.use_count() > 1) {
    held = std::make_shared<Tile>(*held);
  } else {
    // Another thread may have let go of its copy just now; what it read must be done.
    std::atomic_thread_fence(std::memory_order_acquire);
  }
  const int change = int{now} - int{held->bottom[p.at] < held->top[p.at]};
  held->bottom[p.at] = bottom;
  held->top[p.at] = top;
  held->active += change;
  l.active += change;
  if (held->active == 0) held.reset();
}

void PrismFields::insert_layer(int at) {
  Layer layer;
  layer.tiles.resize(std::int64_t{tiles_x_} * tiles_y_);
  layers_.insert(layers_.begin() + at, std::move(layer));
}

double PrismFields::overlap_around(int layer, int i, int j, Matter matter) const {
  double sum = 0;
  for (const auto& step : beside) {
    const int a = i + step[0], b = j + step[1];
    if (a < 0 || b < 0 || a >= frame_.nx || b >= frame_.ny) continue;
    const Matter p = point(layer, a, b);
    if (p.bottom < p.top)
      sum += std::max(0.0f, std::min(p.top, matter.top) - std::max(p.bottom, matter.bottom));
  }
  return sum;
}

int PrismFields::layer_for(int i, int j, Matter matter, int below, int above) {
  if (below + 1 == above) {
    insert_layer(above);
    return above;
  }
  int best = below + 1;
  if (best + 1 == above) return best;
  double most = overlap_around(best, i, j, matter);
  for (int l = best + 1; l < above; ++l) {
    const double overlap = overlap_around(l, i, j, matter);
    if (overlap > most) most = overlap, best = l;
  }
  return best;
}

bool PrismFields::remove(int i, int j, float lo, float hi) {
  const Place p = place(i, j);
  bool changed = false;
  int above = layers();  // the active layer next above
  for (int l = layers() - 1; l >= 0; --l) {
    const Tile* t = tile(l, p.tile);
    if (!t) continue;
    const float bottom = t->bottom[p.at], top = t->top[p.at];
    if (!(bottom < top)) continue;
    if (lo >= top) break;
    if (hi > bottom) {
      const bool lower = lo - bottom >= thinnest_, upper = top - hi >= thinnest_;
      changed = true;
      if (lower && upper) {
        const int target = layer_for(i, j, {hi, top}, l, above);
        set(target, p, hi, top);
        set(l, p, bottom, lo);
      } else if (lower) {
        set(l, p, bottom, lo);
      } else if (upper) {
        set(l, p, hi, top);
      } else {
        set(l, p, 0, 0);
      }
    }
    above = l;
  }
  return changed;
}

bool PrismFields::add(int i, int j, float lo, float hi) {
  const Place p = place(i, j);
  int first = -1, below = -1, above = layers();
  const float spanned[2] = {lo, hi};
  Matter before{};
  bool changed = false;
  for (int l = 0; l < layers(); ++l) {
    const Tile* t = tile(l, p.tile);
    if (!t) continue;
    const Matter now{t->bottom[p.at], t->top[p.at]};
    if (!(now.bottom < now.top)) continue;
    if (now.top < spanned[0]) {
      below = l;
    } else if (now.bottom > spanned[1]) {
      above = l;
      break;
    } else if (first < 0) {
      first = l;
      before = now;
      lo = std::min(lo, now.bottom), hi = std::max(hi, now.top);
    } else {
      hi = std::max(hi, now.top);
      set(l, p, 0, 0);
      changed = true;
    }
  }
  if (first < 0) {
    if (hi - lo < thinnest_) return false;
    set(layer_for(i, j, {lo, hi}, below, above), p, lo, hi);
    return true;
  }
  if (before == Matter{lo, hi}) return changed;
  set(first, p, lo, hi);
  return true;
}

template <class Shape>
ColumnBox PrismFields::apply_shape(const Shape& shape, const Box3d& bounds, Edit mode) {
  // A column that rounding puts at the very rim of the bounds is looked at and found empty.
  constexpr double at_rim = 1e-6;  // columns
  const auto first = [](double d, int n) { return ceil_to(std::clamp<double>(d - at_rim, 0, n)); };
  const auto last = [](double d, int n) { return floor_to(std::clamp<double>(d + at_rim, -1, n - 1)); };
  const int i0 = first((bounds.lo.x - frame_.origin.x) / frame_.dx, frame_.nx);
  const int i1 = last((bounds.hi.x - frame_.origin.x) / frame_.dx, frame_.nx);
  const int j0 = first((bounds.lo.y - frame_.origin.y) / frame_.dy, frame_.ny);
  const int j1 = last((bounds.hi.y - frame_.origin.y) / frame_.dy, frame_.ny);
  ColumnBox changed;
  for (int j = j0; j <= j1; ++j) {
    int from = frame_.nx, to = -1;
    for (int i = i0; i <= i1; ++i) {
      const auto span = shape.column(frame_.x(i), frame_.y(j));
      if (!span) continue;
      const float lo = static_cast<float>(span->lo - frame_.origin.z),
                  hi = static_cast<float>(span->hi - frame_.origin.z);
      if (!(lo < hi)) continue;
      if (!(mode == Edit::remove ? remove(i, j, lo, hi) : add(i, j, lo, hi))) continue;
      from = std::min(from, i), to = i;
    }
    if (to >= 0) changed.expand({from, j, to, j});
  }
  return changed;
}

ColumnBox PrismFields::apply(const Tool& tool, Edit mode) {
  const ColumnBox changed = std::visit(
      [&](const auto& shape) { return apply_shape(shape, shape.bounds(), mode); }, tool.shape().solid);
  settle();
  return changed;
}

void PrismFields::free_empty() {
  std::erase_if(layers_, [](const Layer& l) { return l.active == 0; });
}

void PrismFields::settle() {
  free_empty();
  if (layers() <= most_layers_) return;
  pack();
  most_layers_ = std::max(8, 2 * layers());
}

void PrismFields::set_column(int i, int j, std::span<const Matter> matter) {
  const Place p = place(i, j);
  float above = -std::numeric_limits<float>::infinity();
  for (const Matter& m : matter) {
    if (!(m.bottom > above && m.bottom <= m.top && std::isfinite(m.top)))
      fail(ErrorKind::usage, "the matter of column ({}, {}) is out of order at {} to {} m", i, j, m.bottom,
           m.top);
    above = m.top;
  }
  for (int l = 0; l < layers(); ++l) set(l, p, 0, 0);
  int layer = 0;
  for (const Matter& m : matter) {
    if (m.top - m.bottom < thinnest_) continue;
    if (layer == layers()) insert_layer(layer);
    set(layer++, p, m.bottom, m.top);
  }
  free_empty();
}

void PrismFields::read(const ColumnBox& box, ColumnBlock& out) const {
  out.box = box;
  out.stride = std::max(1, layers());
  const std::size_t columns = box.empty() ? 0 : std::int64_t{box.width()} * box.height();
  out.count.assign(columns, 0);
  if (out.intervals.size() < columns * out.stride) out.intervals.resize(columns * out.stride);
  const int i0 = std::max(box.i0, 0), i1 = std::min(box.i1, frame_.nx - 1);
  const int j0 = std::max(box.j0, 0), j1 = std::min(box.j1, frame_.ny - 1);
  for (int j = j0; j <= j1; ++j)
    for (int start = i0; start <= i1;) {
      const int end = std::min(i1, start / tile_side * tile_side + tile_side - 1);
      const Place p = place(start, j);
      for (int l = 0; l < layers(); ++l) {
        const Tile* t = tile(l, p.tile);
        if (!t) continue;
        std::size_t c = out.column(start, j);
        for (std::size_t a = p.at; a <= p.at + end - start; ++a, ++c)
          if (t->bottom[a] < t->top[a])
            out.intervals[c * out.stride + out.count[c]++] = {t->bottom[a], t->top[a]};
      }
      start = end + 1;
    }
}

std::vector<Matter> PrismFields::column(int i, int j) const {
  std::vector<Matter> out;
  for (int l = 0; l < layers(); ++l)
    if (const Matter p = point(l, i, j); p.bottom < p.top) out.push_back(p);
  return out;
}

int PrismFields::deepest() const {
  int most = 0;
  const std::size_t tiles = std::int64_t{tiles_x_} * tiles_y_;
  for (std::size_t n = 0; n < tiles; ++n) {
    int depth[tile_size] = {};
    for (int l = 0; l < layers(); ++l)
      if (const Tile* t = tile(l, n))
        for (std::size_t a = 0; a < tile_size; ++a) depth[a] += t->bottom[a] < t->top[a];
    most = std::max(most, *std::max_element(depth, depth + tile_size));
  }
  return most;
}

void PrismFields::pack() {
  const std::vector<Layer> old = std::move(layers_);
  layers_.clear();
  for (int l = 0; l < std::ssize(old); ++l) insert_layer(l);
  for (std::size_t n = 0; n < (old.empty() ? 0 : old[0].tiles.size()); ++n) {
    int rank[tile_size] = {};
    for (const Layer& from : old)
      if (const Tile* t = from.tiles[n].get())
        for (std::size_t a = 0; a < tile_size; ++a)
          if (t->bottom[a] < t->top[a]) set(rank[a]++, {n, a}, t->bottom[a], t->top[a]);
  }
  free_empty();
}

Box3d PrismFields::bounds() const {
  ColumnBox columns;
  float lo = std::numeric_limits<float>::infinity(), hi = -lo;
  for (int l = 0; l < layers(); ++l)
    for (int j = 0; j < frame_.ny; ++j)
      for (int i = 0; i < frame_.nx; ++i)
        if (const Matter p = point(l, i, j); p.bottom < p.top) {
          columns.expand(i, j);
          lo = std::min(lo, p.bottom), hi = std::max(hi, p.top);
        }
  if (columns.empty()) return {};
  return {{frame_.x(columns.i0), frame_.y(columns.j0), frame_.origin.z + lo},
          {frame_.x(columns.i1), frame_.y(columns.j1), frame_.origin.z + hi}};
}

std::uint64_t PrismFields::bytes() const {
  std::uint64_t sum = 0;
  for (const Layer& l : layers_) {
    sum += l.tiles.size() * sizeof(l.tiles[0]);
    for (const auto& t : l.tiles)
      if (t) sum += sizeof(Tile);
  }
  return sum;
}

}  // namespace tafoni::volume
