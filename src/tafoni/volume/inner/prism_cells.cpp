// How columns connect across one cell of a prism-field: intervals that overlap along the cell's sides are
// joined into pieces; air within a piece, which ends beside a column, splits it into slabs; see the
// header.

#include "tafoni/volume/inner/prism_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tafoni::volume {

namespace {

bool overlap(const Matter& a, const Matter& b) {
  return a.bottom < b.top && b.bottom < a.top;
}

}  // namespace

void PrismCells::seams_of(int i, int j, const Matter& matter) {
  const ColumnBox& box = block_->box;
  air_.clear();
  for (int b = std::max(j - 1, box.j0); b <= std::min(j + 1, box.j1); ++b)
    for (int a = std::max(i - 1, box.i0); a <= std::min(i + 1, box.i1); ++a) {
      const auto around = block_->at(a, b);
      for (std::size_t n = 1; n < around.size(); ++n)
        if (matter.bottom < around[n - 1].top && around[n].bottom < matter.top)
          air_.emplace_back(around[n - 1].top, around[n].bottom);
    }
  if (air_.empty()) return;
  std::sort(air_.begin(), air_.end());
  float lowest = matter.bottom;
  for (std::size_t n = 0; n < air_.size();) {
    Seam seam{air_[n].first, air_[n].second, 0};
    double sum = 0;
    const std::size_t begin = n;
    for (; n < air_.size() && air_[n].first < seam.hi; ++n) {
      seam.hi = std::max(seam.hi, air_[n].second);
      sum += 0.5 * (double{air_[n].first} + air_[n].second);
    }
    const float z = static_cast<float>(sum / static_cast<double>(n - begin));
    if (!(z > lowest && z < matter.top)) continue;  // rounded onto its neighbour
    lowest = z;
    seam.place = end_of(levels_);
    levels_.push_back(z);
    seams_.push_back(seam);
  }
}

void PrismCells::column(int i, int j) {
  const auto all = block_->at(i, j);
  starts_.push_back(end_of(levels_));
  seam_starts_.push_back(end_of(seams_));
  const std::size_t base = block_->column(i, j) * block_->stride;
  for (std::size_t n = 0; n < all.size(); ++n) {
    Range& range = ranges_[base + n];
    range.first = end_of(levels_);
    levels_.push_back(all[n].bottom);
    if (near_air_[block_->column(i, j)]) seams_of(i, j, all[n]);
    range.last = end_of(levels_);
    levels_.push_back(all[n].top);
  }
}

/// Columns with air between matter, and those around them.
void PrismCells::find_air() {
  const ColumnBox& box = block_->box;
  near_air_.assign(block_->count.size(), 0);
  for (int j = box.j0; j <= box.j1; ++j)
    for (int i = box.i0; i <= box.i1; ++i) {
      if (block_->count[block_->column(i, j)] < 2) continue;
      for (int b = std::max(j - 1, box.j0); b <= std::min(j + 1, box.j1); ++b)
        for (int a = std::max(i - 1, box.i0); a <= std::min(i + 1, box.i1); ++a)
          near_air_[block_->column(a, b)] = 1;
    }
}

void PrismCells::build(const ColumnBlock& block) {
  block_ = &block;
  find_air();
  levels_.clear(), starts_.clear(), seams_.clear(), seam_starts_.clear();
  if (ranges_.size() < block.intervals.size()) ranges_.resize(block.intervals.size());
  for (int j = block.box.j0; j <= block.box.j1; ++j)
    for (int i = block.box.i0; i <= block.box.i1; ++i) column(i, j);
  seam_starts_.push_back(end_of(seams_));
}

/// The frequent case: one interval a corner, all overlapping.
bool PrismCells::simple(const std::array<std::size_t, 4>& columns, Slab& slab) const {
  for (std::size_t k = 0; k < 4; ++k)
    if (block_->count[columns[k]] != 1) return false;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!overlap(matter(columns[k], 0), matter(columns[(k + 1) % 4], 0))) return false;
    slab.at[k] = range(columns[k], 0);
  }
  slab.corners = 15;
  slab.piece = 0;
  return true;
}

std::span<const PrismCells::Slab> PrismCells::slabs(int i, int j, DeadPoints dead) {
  slabs_.clear();
  std::array<std::size_t, 4> columns;
  int filled = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    columns[k] = block_->column(i + cell_corners[k][0], j + cell_corners[k][1]);
    filled += block_->count[columns[k]] > 0;
  }
  if (filled < (dead == DeadPoints::quads ? 4 : 3)) return {};
  if (Slab slab; simple(columns, slab)) {
    slabs_.push_back(slab);
    return slabs_;
  }
  pieces(columns);
  for (std::int32_t n = 0; n < std::ssize(nodes_); ++n)
    if (nodes_[n].root == n) emit(columns, n, dead);
  return slabs_;
}

/// Joins what overlaps along the cell's sides; a root is the lowest node of its set.
void PrismCells::pieces(const std::array<std::size_t, 4>& columns) {
  nodes_.clear();
  for (int k = 0; k < 4; ++k) {
    node_starts_[k] = end_of(nodes_);
    for (int n = 0; n < block_->count[columns[k]]; ++n) nodes_.push_back({k, n, end_of(nodes_)});
  }
  node_starts_[4] = end_of(nodes_);
  const auto root = [&](std::int32_t n) {
    while (nodes_[n].root != n) n = nodes_[n].root;
    return n;
  };
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t l = (k + 1) % 4;
    for (std::int32_t a = node_starts_[k]; a < node_starts_[k + 1]; ++a)
      for (std::int32_t b = node_starts_[l]; b < node_starts_[l + 1]; ++b) {
        if (!overlap(matter(columns[k], nodes_[a].interval), matter(columns[l], nodes_[b].interval)))
          continue;
        const std::int32_t x = root(a), y = root(b);
        nodes_[std::max(x, y)].root = std::min(x, y);
      }
  }
  for (std::int32_t n = 0; n < std::ssize(nodes_); ++n) nodes_[n].root = root(n);
}

void PrismCells::emit(const std::array<std::size_t, 4>& columns, std::int32_t root, DeadPoints dead) {
  Slab whole;
  whole.piece = root;
  gaps_.clear();
  std::array<int, 4> last{-1, -1, -1, -1};
  for (const Node& node : nodes_) {
    if (node.root != root) continue;
    const int k = node.corner;
    const Range here = range(columns[k], node.interval);
    if (last[k] < 0) {
      whole.at[k].first = here.first;
      whole.corners = static_cast<std::uint8_t>(whole.corners | (1u << k));
    } else {
      gaps_.push_back({matter(columns[k], last[k]).top,
                       matter(columns[k], node.interval).bottom,
                       node.corner,
                       {whole.at[k].last, here.first},
                       end_of(gaps_)});
    }
    whole.at[k].last = here.last;
    last[k] = node.interval;
  }
  if (std::popcount(whole.corners) < (dead == DeadPoints::quads ? 4 : 3)) return;
  if (gaps_.empty())
    slabs_.push_back(whole);
  else
    split(columns, root, whole);
}

/// Where matter of an interval ends beside the gap: at the seam made by it, or where the interval ends.
PrismCells::Range PrismCells::cut(std::size_t column, int interval, const Gap& gap) const {
  const Range own = range(column, interval);
  for (std::int32_t s = seam_starts_[column]; s < seam_starts_[column + 1]; ++s) {
    const Seam& seam = seams_[s];
    if (seam.place > own.first && seam.place < own.last && seam.lo < gap.hi && gap.lo < seam.hi)
      return {seam.place, seam.place};
  }
  const Matter& m = matter(column, interval);
  const std::int32_t end = gap.lo + gap.hi > m.bottom + m.top ? own.last : own.first;
  return {end, end};
}

/// Air that overlaps is one and divides the piece of matter: below it is a slab, above it the next.
void PrismCells::split(const std::array<std::size_t, 4>& columns, std::int32_t root, Slab whole) {
  for (std::size_t a = 0; a < gaps_.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      if (gaps_[a].corner == gaps_[b].corner || !(gaps_[a].lo < gaps_[b].hi && gaps_[b].lo < gaps_[a].hi))
        continue;
      const int from = gaps_[a].set, to = gaps_[b].set;
      for (Gap& g : gaps_)
        if (g.set == from) g.set = to;
    }
  std::stable_sort(gaps_.begin(), gaps_.end(),
                   [](const Gap& a, const Gap& b) { return a.lo + a.hi < b.lo + b.hi; });
  std::array<std::int32_t, 4> floor{};
  for (std::size_t k = 0; k < 4; ++k) floor[k] = whole.at[k].first;
  for (std::size_t n = 0; n < gaps_.size(); ++n) {
    const int set = gaps_[n].set;
    if (std::any_of(gaps_.begin(), gaps_.begin() + n, [&](const Gap& g) { return g.set == set; })) continue;
    Slab lower = whole;
    std::array<std::int32_t, 4> next = floor;
    for (int k = 0; k < 4; ++k) {
      if (!(whole.corners >> k & 1)) continue;
      Range at{-1, -1};
      for (const Gap& g : gaps_) {
        if (g.set != set || g.corner != k) continue;
        if (at.first < 0) at.first = g.ends.first;
        at.last = g.ends.last;
      }
      if (at.first < 0) {
        // The interval of this corner that the air is shut at: the one that reaches nearest to its middle.
        const float middle = 0.5f * (gaps_[n].lo + gaps_[n].hi);
        int best = -1;
        float least = 0;
        for (const Node& node : nodes_) {
          if (node.root != root || node.corner != k) continue;
          const Matter& m = matter(columns[k], node.interval);
          const float off = std::max({m.bottom - middle, middle - m.top, 0.0f});
          if (best < 0 || off < least) best = node.interval, least = off;
        }
        at = cut(columns[k], best, gaps_[n]);
      }
      lower.at[k] = {floor[k], std::max(floor[k], at.first)};
      next[k] = std::max(lower.at[k].last, at.last);
    }
    slabs_.push_back(lower);
    floor = next;
  }
  for (std::size_t k = 0; k < 4; ++k) whole.at[k] = {floor[k], std::max(floor[k], whole.at[k].last)};
  slabs_.push_back(whole);
}

bool PrismCells::cut_0_to_2(std::span<const Slab> slabs) const {
  if (slabs.empty()) return true;
  const Slab& top = slabs.back();
  if (top.corners != 15) return true;
  const auto z = [&](std::size_t k) { return level(top.at[k].last); };
  return std::abs(z(0) - z(2)) <= std::abs(z(1) - z(3));
}

}  // namespace tafoni::volume
