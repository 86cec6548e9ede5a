// An engine's heightmap is known by what it is: a grey picture of 16 bits, or floats from 0 to 1, that says
// neither where it lies nor what its numbers mean. Depths are known by what the file says of them.

#include "tafoni/io/impl/stored_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <cpl_string.h>

#include "tafoni/math/whole.h"

namespace tafoni::io::impl {
namespace {

/// Metres from black to white that a heightmap is taken to span: what Unreal makes of one at its usual scale.
constexpr double heightmap_span = 512;
/// Parts of the span by which resampling may have taken floats beyond 0 and 1.
constexpr double beyond_unit = 0.05;
/// Metres: no ground is lower or higher, so whole numbers beyond are an engine's units.
constexpr double lowest_ground = -11'000, highest_ground = 9'000;
/// Rows from which the range of a file's numbers is judged.
constexpr int ranged_rows = 64;

/// What some rows of a file hold.
struct Sampled {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  double sum = 0;
  bool whole = true;
};

/// Nothing is sampled of a file that cannot be read there: reading it in earnest says so.
Sampled sample_numbers(DemSource& source) {
  Sampled out;
  const ReadReport before = source.report;
  std::vector<double> row(source.width());
  try {
    for (const int r : spread_rows(source.height(), ranged_rows)) {
      source.read(0, 0, r, source.width(), 1, row.data());
      for (const double v : row) {
        if (std::isnan(v)) continue;
        out.lo = std::min(out.lo, v);
        out.hi = std::max(out.hi, v);
        out.sum += v;
        out.whole = out.whole && v == std::trunc(v);
      }
    }
  } catch (const Error&) {
    out = {};
  }
  source.report = before;
  return out;
}

void take_units(DemSource& source) {
  source.scale = heightmap_span / 65536;
  source.notes.push_back(
      "a 16-bit heightmap says nothing of heights; taken as 1/128 m a unit, 512 m from black to white; "
      "terrain.height_scale says otherwise (1 where its numbers are metres).");
}

void take_unit_range(DemSource& source) {
  source.scale = heightmap_span;
  source.notes.push_back(
      "a heightmap of floats from 0 to 1 says nothing of heights; taken as 512 m from 0 to 1; "
      "terrain.height_scale says otherwise (1 where its numbers are metres).");
}

bool is_float(const DemSource& source) {
  return source.stored_type == GDT_Float32 || source.stored_type == GDT_Float64;
}

/// What was asked for as a heightmap.
void take_as_heightmap(DemSource& source) {
  if (source.bytes) {
    source.scale = heightmap_span / 256;
    source.notes.push_back("an 8-bit heightmap is taken as 2 m a unit, 512 m from black to white.");
    return;
  }
  const Sampled numbers = is_float(source) ? sample_numbers(source) : Sampled{};
  if (is_float(source) && numbers.hi <= 1 + beyond_unit)
    take_unit_range(source);
  else
    take_units(source);
}

/// A file that says neither where it lies nor what its numbers mean.
void guess(DemSource& source) {
  if (source.stored_type == GDT_UInt16) return take_units(source);
  if (source.bytes) {
    source.notes.push_back(
        "an 8-bit picture says nothing of heights; taken as 1 m a unit; terrain.height_scale says "
        "otherwise.");
    return;
  }
  const Sampled numbers = sample_numbers(source);
  const bool unit_range = numbers.lo >= -beyond_unit && numbers.hi <= 1 + beyond_unit;
  const bool units = numbers.whole && numbers.lo >= -32768 && numbers.hi <= 65535 &&
                     (numbers.lo < lowest_ground || numbers.hi > highest_ground);
  if (is_float(source) && unit_range && numbers.lo < numbers.hi)
    take_unit_range(source);
  else if (units)
    take_units(source);
}

void turn_depths(DemSource& source) {
  const Depths& depths = *source.depths;
  if (depths.where == DepthsWhere::most_positive && !(sample_numbers(source).sum > 0)) return;
  if (depths.where == DepthsWhere::all_positive) {
    const Sampled numbers = sample_numbers(source);
    if (!(numbers.lo >= 0 && numbers.sum > 0)) return;
  }
  source.scale = -source.scale;
  source.offset = -source.offset;
  source.notes.push_back(fmt::format(
      "holds depths, positive down ({}); turned to heights below zero; terrain.height_scale says otherwise.",
      depths.why));
}

std::string lowered(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

/// Whether one of the words of a text, which letters make, is among `words`.
bool speaks_of(std::string_view text, std::initializer_list<std::string_view> words) {
  std::string word;
  for (const char c : lowered(text) + " ") {
    if (std::isalpha(static_cast<unsigned char>(c))) {
      word += c;
      continue;
    }
    if (std::find(words.begin(), words.end(), word) != words.end()) return true;
    word.clear();
  }
  return false;
}

bool names_depths(std::string_view text) {
  return speaks_of(text, {"depth", "depths", "sounding", "soundings"});
}

/// Bathymetry is as often heights below zero.
bool names_sea_floor(std::string_view text) {
  return speaks_of(text, {"bathymetry", "bathymetric", "bathy"}) &&
         !speaks_of(text, {"topo", "topography", "topographic", "land"});
}

bool names_heights(std::string_view text) {
  return speaks_of(text, {"elevation", "elevations", "height", "heights", "altitude", "negative", "up"});
}

std::optional<Depths> depths_in(std::string_view text, const std::string& why) {
  if (names_heights(text)) return std::nullopt;
  if (names_depths(text)) return Depths{why, DepthsWhere::most_positive};
  if (names_sea_floor(text)) return Depths{why, DepthsWhere::all_positive};
  return std::nullopt;
}

/// A name as depths.tif says little, but is worth a word.
void hint_by_name(DemSource& source) {
  const std::string stem = std::filesystem::path(source.name).stem().string();
  if (!(names_depths(stem) || names_sea_floor(stem)) || !(sample_numbers(source).lo >= 0)) return;
  source.notes.push_back(
      "its name speaks of depths, but nothing in it does; taken as heights; terrain.height_scale = -1 turns "
      "depths in metres upside down.");
}

/// What one item of metadata, "NAME=VALUE", says of depths; `variable` is what its band is called.
std::optional<Depths> depths_by(std::string_view item, std::string_view variable) {
  const auto equals = item.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  std::string name = lowered(item.substr(0, equals));
  const std::string value = lowered(item.substr(equals + 1));
  if (const auto hash = name.find('#'); hash != std::string::npos) {
    // NetCDF's attributes of all variables stand together.
    if (name.substr(0, hash) != lowered(variable)) return std::nullopt;
    name.erase(0, hash + 1);
  }
  if (name.ends_with("positive") && value.starts_with("down")) return Depths{"positive = down"};
  if (value.find("positive down") != std::string::npos) return Depths{fmt::format("{} says so", name)};
  constexpr std::array<std::string_view, 6> telling = {
      "standard_name", "long_name", "description", "tifftag_imagedescription", "netcdf_varname", "band_name"};
  const bool tells = std::find(telling.begin(), telling.end(), name) != telling.end();
  if (!tells) return std::nullopt;
  return depths_in(value, fmt::format("its {} is \"{}\"", name, value.substr(0, 60)));
}

}  // namespace

std::vector<int> spread_rows(int height, int most) {
  std::vector<int> out(std::min(height, most));
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<int>((2 * i + 1) * static_cast<std::size_t>(height) / (2 * out.size()));
  return out;
}

std::optional<Depths> depths_of(GDALDataset& dataset, GDALRasterBand& band) {
  if (const OGRSpatialReference* crs = dataset.GetSpatialRef(); crs != nullptr && crs->IsVertical()) {
    OGRAxisOrientation axis = OAO_Other;
    if (crs->GetAxis("VERT_CS", 0, &axis) != nullptr && axis == OAO_Down)
      return Depths{"its vertical axis points down"};
  }
  const char* variable = band.GetMetadataItem("NETCDF_VARNAME");
  std::optional<Depths> found;
  const auto look = [&](char** items) {
    for (; items != nullptr && *items != nullptr; ++items)
      if (const auto depths = depths_by(*items, variable != nullptr ? variable : "");
          depths && !(found && found->where <= depths->where))
        found = depths;
  };
  look(band.GetMetadata());
  look(dataset.GetMetadata());
  if (!found)
    found = depths_in(band.GetDescription(), fmt::format("its band is called \"{}\"", band.GetDescription()));
  return found;
}

void interpret(DemSource& source, const DemOptions& options) {
  if (options.height_scale != 0) {
    source.scale = options.height_scale;
    source.offset = 0;
    source.unit = 1;
    source.height_unit = "metre";
    source.unit_stated = true;
  } else if (options.encoding == HeightEncoding::heightmap) {
    take_as_heightmap(source);
  } else if (options.encoding == HeightEncoding::automatic && !source.decoded) {
    if (source.depths)
      turn_depths(source);
    else if (!source.georeferenced && !source.says_of_heights)
      guess(source);
    if (!source.depths) hint_by_name(source);
  }
  source.offset += options.height_offset / source.unit;
}

}  // namespace tafoni::io::impl
