// Chambers [Ju01 §4]: a lattice of a few values, written as text or taken from a preset, is subdivided
// smoothly into a grid about as fine as wanted, which is asked by trilinear interpolation and closed at
// its border.

#include "tafoni/volume/chamber.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/registry.h"
#include "tafoni/math/whole.h"
#include "tafoni/volume/fractal.h"

namespace tafoni::volume {
namespace {

/// Halvings of a cell at most, to samples a 256th of it apart.
constexpr int most_levels = 8;
/// Levels by which the logarithm of a whole number of halvings may be off.
constexpr double rounding = 1e-9;
/// Samples of a chamber at most: 1 GB of them.
constexpr double most_samples = 0x1p28;
/// Values of a lattice at most, which is one of 100 a side.
constexpr std::size_t most_values = 1'000'000;
/// Cells from the border of the lattice within which all is rock: less than one, so that what the values next
/// to the border leave open stays.
constexpr double rim = 0.4;

std::vector<std::string_view> split(std::string_view text, std::string_view marks) {
  std::vector<std::string_view> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(marks), text.size());
    std::string_view part = text.substr(0, end);
    while (!part.empty() && std::string_view(" \t\r\n").find(part.front()) != part.npos)
      part.remove_prefix(1);
    while (!part.empty() && std::string_view(" \t\r\n").find(part.back()) != part.npos) part.remove_suffix(1);
    if (!part.empty()) out.push_back(part);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::vector<float> row_of(std::string_view row, std::string_view where) {
  constexpr std::string_view letters = ".-o+#";
  std::vector<float> out;
  if (row.find_first_not_of(letters) == row.npos) {
    for (char c : row) out.push_back(0.5f * static_cast<float>(letters.find(c)) - 1);
    return out;
  }
  for (std::string_view word : split(row, " \t")) {
    float v = 0;
    const auto [end, wrong] = std::from_chars(word.data(), word.data() + word.size(), v);
    if (wrong != std::errc() || end != word.data() + word.size() || !std::isfinite(v))
      fail(ErrorKind::usage, "{}: \"{}\" is neither a number nor made of # + o - .", where, word);
    out.push_back(v);
  }
  return out;
}

/// Metres: the slope across a cell from rock to open is 1.
FractalSettings settings_of(const ChamberLattice& lattice, const ChamberSettings& s) {
  FractalSettings out;
  out.cells = lattice.cells;
  out.levels = std::clamp(ceil_to(std::log2(s.cell / s.spacing) - rounding), 1, most_levels);
  out.spacing = std::ldexp(s.cell, -out.levels);
  for (float v : lattice.values) out.coarse.push_back(static_cast<float>(0.5 * s.cell) * v);
  // The last level is smooth.
  out.noise = decaying_noise(s.noise * s.cell, 0.5, out.levels, 1);
  out.seed = s.seed;
  const Vec3i n = out.size();
  if (1.0 * n.x * n.y * n.z > most_samples)
    fail(ErrorKind::usage,
         "a chamber of {} x {} x {} samples is more than 2^28; give a spacing above {:.3g} m, or smaller "
         "cells",
         n.x, n.y, n.z, out.spacing);
  return out;
}

const char* const storage = R"(
###########/###########/###########/###########/###########/###########/###########/###########/###########/###########/###########;
###########/##.......##/#.........#/#..#...#..#/#.........#/#.........#/#.........#/#..#...#..#/#.........#/##.......##/###########;
###########/##.......##/#.........#/#..#...#..#/#.........#/#.........#/#.........#/#..#...#..#/#.........#/##.......##/###########;
###########/##.......##/#.........#/#..#...#..#/#...-o-...#/#...o+o...#/#...-o-...#/#..#...#..#/#.........#/##.......##/###########;
###########/##.......##/#.........#/#..#+o+#..#/#..+###+..#/#..o###o..#/#..+###+..#/#..#+o+#..#/#.........#/##.......##/###########;
###########/###.....###/##.-+++-.##/#.-#####-.#/#.+#####+.#/#.+#####+.#/#.+#####+.#/#.-#####-.#/##.-+++-.##/###.....###/###########;
###########/###########/###########/###########/###########/###########/###########/###########/###########/###########/###########)";

const char* const queen = R"(
#############/#############/#############/#############/#############/#############/#############/#############/#############/#############/#############/#############/#############;
#############/###.......###/##.........##/#...-----...#/#..-ooooo-..#/#..-o+++o-..#/#..-o+#+o-..#/#..-o+++o-..#/#..-ooooo-..#/#...-----...#/##.........##/###.......###/#############;
#############/###.......###/##.........##/#...........#/#...........#/#...........#/#...........#/#...........#/#...........#/#...........#/##.........##/###.......###/#############;
#############/###.......###/##.........##/#...........#/#...-...-...#/#...........#/#...........#/#...........#/#...-...-...#/#...........#/##.........##/###.......###/#############;
#############/####.....####/##.........##/#..-o-.-o-..#/#..o#o.o#o..#/#..-o-.-o-..#/#...........#/#..-o-.-o-..#/#..o#o.o#o..#/#..-o-.-o-..#/##.........##/####.....####/#############;
#############/#####...#####/###.......###/##.o#o.o#o.##/#..###.###..#/#..o#o.o#o..#/#...........#/#..o#o.o#o..#/#..###.###..#/##.o#o.o#o.##/###.......###/#####...#####/#############;
#############/#############/####-----####/###+##o##+###/##+###o###+##/##-###-###-##/##-ooo.ooo-##/##-###-###-##/##+###o###+##/###+##o##+###/####-----####/#############/#############;
#############/#############/#############/#############/#############/#############/#############/#############/#############/#############/#############/#############/#############)";

const char* const hall = R"(
#######/#######/#######/#######/#######/#######/#######;
#######/##...##/#.....#/#.....#/#.....#/##...##/#######;
#######/##...##/#.....#/#.....#/#.....#/##...##/#######;
#######/###-###/##...##/#-...-#/##...##/###-###/#######;
#######/#######/#######/#######/#######/#######/#######)";

}  // namespace

ChamberLattice parse_lattice(std::string_view text, std::string_view where) {
  ChamberLattice out;
  const auto layers = split(text, ";");
  std::size_t rows = 0, columns = 0;
  for (std::string_view layer : layers) {
    const auto lines = split(layer, "/\n");
    if (rows == 0) rows = lines.size();
    if (lines.size() != rows)
      fail(ErrorKind::usage, "{}: a layer has {} rows where the first has {}", where, lines.size(), rows);
    std::vector<std::vector<float>> read;
    for (std::string_view line : lines) {
      read.push_back(row_of(line, where));
      if (columns == 0) columns = read.back().size();
      if (read.back().size() != columns)
        fail(ErrorKind::usage, "{}: the row \"{}\" has {} values where the first has {}", where, line,
             read.back().size(), columns);
    }
    for (auto row = read.rbegin(); row != read.rend(); ++row)
      out.values.insert(out.values.end(), row->begin(), row->end());
  }
  if (layers.size() < 2 || rows < 2 || columns < 2 || out.values.size() > most_values)
    fail(ErrorKind::usage,
         "{}: a lattice takes at least 2 x 2 x 2 values and at most a million; layers end with ;", where);
  for (const float v : out.values)
    if (v < -1 || v > 1)
      fail(ErrorKind::usage, "{}: {} is not between -1, which is open, and 1, which is rock", where, v);
  const auto cells = [](std::size_t values) { return static_cast<int>(values) - 1; };
  out.cells = {cells(columns), cells(rows), cells(layers.size())};
  return out;
}

std::span<const ChamberPreset> chamber_presets() {
  static const std::vector<ChamberPreset> presets = {
      {"storage", "a huge bulge hanging from the ceiling, on four columns", storage, 2.4},
      {"queen", "four bulges hanging above a platform in the middle", queen, 2.6},
      {"hall", "a plain vaulted room", hall, 2.4}};
  return presets;
}

const ChamberPreset& find_chamber_preset(std::string_view name) {
  std::vector<std::string> known;
  for (const ChamberPreset& preset : chamber_presets()) {
    if (preset.name == name) return preset;
    known.push_back(preset.name);
  }
  fail_unknown("chamber", name, known);
}

Chamber::Chamber(const ChamberLattice& lattice, const ChamberSettings& settings)
    : settings_(settings),
      size_{lattice.cells.x * settings.cell, lattice.cells.y * settings.cell,
            lattice.cells.z * settings.cell},
      grid_({{0, 0, 0}, 1, {2, 2, 2}}, 0) {
  if (!(settings.cell > 0) || !(settings.spacing > 0) || !std::isfinite(settings.cell) ||
      !std::isfinite(settings.spacing) || !(settings.noise >= 0))
    fail(ErrorKind::usage,
         "a chamber's cells and spacing must be positive lengths in metres, its noise 0 or more");
  grid_ = Fractal(settings_of(lattice, settings)).grid();
}

double Chamber::value(Vec3d p) const {
  const double c = std::cos(settings_.turn), s = std::sin(settings_.turn);
  const Vec3d d = p - settings_.position;
  const Vec3d q{c * d.x + s * d.y + 0.5 * size_.x, -s * d.x + c * d.y + 0.5 * size_.y, d.z};
  const double inside = std::min({q.x, q.y, q.z, size_.x - q.x, size_.y - q.y, size_.z - q.z});
  return std::max<double>(grid_.value(q), rim * settings_.cell - inside);
}

Box3d Chamber::bounds() const {
  const double c = std::abs(std::cos(settings_.turn)), s = std::abs(std::sin(settings_.turn));
  const double x = 0.5 * (c * size_.x + s * size_.y), y = 0.5 * (s * size_.x + c * size_.y);
  const Vec3d& p = settings_.position;
  return {{p.x - x, p.y - y, p.z}, {p.x + x, p.y + y, p.z + size_.z}};
}

SampleBox carve(ScalarGrid& grid, const Chamber& chamber) {
  const GridFrame frame = grid.frame();
  return grid.edit(grid.samples_in(chamber.bounds()), [&](Vec3i first, std::span<float> row) {
    for (int i = 0; i < std::ssize(row); ++i) {
      const double v = chamber.value(frame.position(first + Vec3i{i, 0, 0}));
      row[i] = std::min(row[i], static_cast<float>(v));
    }
  });
}

}  // namespace tafoni::volume
