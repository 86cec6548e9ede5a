// Every parameter of every landform is set to both ends and to the middle of its range; what is made must
// change, on one of four sites, or the declaration says by ParamTable::only() where it does.

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>

#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms {
namespace {

/// Beds of hard and of soft rock, that dip a little.
double layered(Vec3d p) {
  return 0.4 + 0.35 * std::sin(0.9 * p.z + 0.05 * p.x);
}

/// A sea cliff cut by a ravine with a stream.
double coast(double x, double y) {
  const double bed = std::max(0.5, 1.5 + 0.12 * y), off = std::abs(x - 24 - 4 * std::sin(y / 12));
  return std::min(test::Coast::ground(x, y), y > -4 ? bed + 1.6 * off : 1e9);
}

/// A mesa above gentle ground: a closed depression and a hill on it, a fin of rock at its foot.
double mesa(double x, double y) {
  const auto bell = [](double dx, double dy, double r) { return std::exp(-(dx * dx + dy * dy) / (r * r)); };
  const double rise = std::clamp((y + 4 + 3 * std::sin(0.15 * x)) / 4, 0.0, 1.0);
  const double z = 12 + 0.06 * y + 0.4 * std::sin(0.4 * x) * std::cos(0.3 * y) + 26 * rise +
                   rise * (8 * bell(x - 30, y - 24, 12) - 9 * bell(x + 28, y - 20, 8));
  return std::abs(y + 24) < 2.5 && std::abs(x + 30) < 18 ? 32 + 0.5 * std::sin(x) : z;
}

/// Two valleys: a gorge between high walls in the west, a gentle one in the east; there, a wall of rock
/// across one half of which is thin and the other thick.
double gorge(double x, double y) {
  const double west = std::abs(x + 20), east = std::abs(x - 38);
  double z = 14 + 0.12 * y + 0.3 * std::sin(0.5 * x) + std::min({0.4 * west, 0.4 * east, 4.0});
  if (west > 6 && west < 22) z = 36 + 0.05 * y;
  if (x > 12 && x < 50 && std::abs(y - 12) < (x < 31 ? 2.5 : 7)) z = 40;
  return z;
}

struct Place {
  test::Coast land;
  Region region;
};

/// A coast, a mesa, valleys, and the mesa where only a part may change.
const std::vector<std::unique_ptr<Place>>& places() {
  static const auto made = [] {
    std::vector<std::unique_ptr<Place>> all;
    for (const auto& elevation : {&coast, &mesa, &gorge, &mesa})
      all.push_back(std::make_unique<Place>(Place{test::Coast(layered, elevation), {}}));
    all.back()->region.limit_box({{-45, -30, -20}, {45, 36, 80}});
    all.back()->land.site.region = &all.back()->region;
    return all;
  }();
  return made;
}

/// Where fields are compared: half of the places lie near the ground, the others anywhere.
std::vector<Vec3d> probes(const Site& site) {
  constexpr int n = 6000;
  const Box3d box{{-58, -43, -20}, {58, 43, 70}};
  std::vector<Vec3d> points = test::places(box, n, 12);
  const raster::Raster& heights = *site.heights;
  for (int i = 0; i < n; i += 2) {
    Vec3d& p = points[i];
    const int col = std::clamp(floor_to(p.x + 60), 0, heights.values.width() - 1);
    const int row = std::clamp(floor_to(45 - p.y), 0, heights.values.height() - 1);
    p.z = heights.values.at(col, row) + 0.1 * (p.z - 25);
  }
  return points;
}

/// A hash of the field's values where it is probed; none where the landform refuses the values.
std::optional<std::uint64_t> made(const LandformType& type, const Site& site, const Values& values) {
  try {
    const Result result = type.generate(site, values, silent());
    std::uint64_t hash = 0;
    for (const float f : test::values(test::carved(site, result), probes(site)))
      hash = hash_combine(hash, std::bit_cast<std::uint32_t>(f));
    return hash;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
    return std::nullopt;
  }
}

/// Texts, tables and lists of any length have no range; these are values that tell. Cells of 40 m, which
/// range() would give, make chambers that take half a minute to carve.
const std::map<std::string, std::vector<Value>>& telling() {
  using Numbers = std::vector<double>;
  static const std::map<std::string, std::vector<Value>> values = {
      {"chambers.cell", {0.0, 3.0, 6.0}},
      {"chambers.chamber", {Rows{}, Rows{{{"at", "499990 4000012 22"}}}}},
      {"explosions.blast", {Rows{}, Rows{{{"at", "499990 4000012 38"}}}}},
      {"fractal-terrain.pin", {Rows{}, Rows{{{"x", "499990"}, {"y", "4000012"}, {"value", "-9"}}}}},
      {"grammar-cave.at", {Numbers{}, Numbers{499980, 4000000, 0}}},
      {"grammar-cave.rule",
       {Rows{}, Rows{{{"symbol", "Cave"}, {"shape", "cube"}, {"next", "Cave"}}},
        Rows{{{"symbol", "Cave"}, {"shape", "sphere"}, {"next", "Cave"}}}}},
      {"grammar-cave.solids", {"cube", "torus"}},
      {"heightfield.generator", {"plateau", "coast"}},
      {"hive.kinds", {"queen", "storage"}},
      {"hoodoos.at", {Numbers{}, Numbers{499990, 4000012}}},
      {"hoodoos.axiom", {"Hoodoo", "Head"}},
      {"hoodoos.rule",
       {Rows{{{"symbol", "Hoodoo"}, {"make", "ellipsoid(hx = s, hy = s, hz = 2*s)"}}},
        Rows{{{"symbol", "Hoodoo"}, {"make", "ellipsoid(hx = s, hy = s, hz = 3*s)"}}}}},
      {"karst.springs", {Numbers{}, Numbers{499990, 3999990, 13}}},
      {"prism-field.at", {Numbers{}, Numbers{499990, 3999990, 20}}},
      {"prism-field.tool",
       {Rows{}, Rows{{{"tool", "sphere"}, {"at", "499990 4000012 30"}, {"radius", "5"}}}}},
      {"tunnels.tunnel", {Rows{}, Rows{{{"from", "499985 3999990 14"}, {"to", "499995 4000030 20"}}}}},
  };
  return values;
}

/// What else is set: their own sampling, a 400th of the site, tells no more and takes twenty times as long.
const std::map<std::string, Values>& quick() {
  static const std::map<std::string, Values> values = {{"fractal-terrain", {{"spacing", 1.5}}},
                                                       {"hive", {{"spacing", 1.5}}}};
  return values;
}

/// What is set: both ends of the range and the middle. A range that is far larger than the sites, which are
/// 120 m wide, or than the default would only cost time: then its upper end is eight times the default, or 40
/// metres, or 24 of what is counted, whichever is most, and a lower end that is not 0 is no less than a
/// quarter of the default.
std::pair<double, double> range(const ParamInfo& info, double init) {
  double lo = info.min, hi = info.max;
  const bool length = info.unit == "m" || info.unit == "m2";
  if (length || info.kind == ValueKind::integer || hi > 10) {
    const double least = info.unit == "m2" ? 1600 : length ? 40 : info.kind == ValueKind::integer ? 24 : 90;
    hi = std::min(hi, std::max(8 * std::abs(init), least));
    lo = lo < 0 ? std::max(lo, -hi) : lo == 0 ? 0 : std::max(lo, std::min(init / 4, hi));
  }
  return {lo, hi};
}

std::vector<Value> values_of(const ParamInfo& info, const std::string& key) {
  if (const auto own = telling().find(key); own != telling().end()) return own->second;
  std::vector<Value> out;
  if (info.kind == ValueKind::boolean) return {false, true};
  if (info.kind == ValueKind::choice) {
    for (const std::string& choice : info.choices) out.emplace_back(choice);
  } else if (info.kind == ValueKind::integer) {
    const auto [lo, hi] = range(info, static_cast<double>(std::get<std::int64_t>(info.init)));
    for (const double v : {lo, std::floor((lo + hi) / 2), hi}) out.emplace_back(static_cast<std::int64_t>(v));
  } else if (info.kind == ValueKind::real) {
    const auto [lo, hi] = range(info, std::get<double>(info.init));
    for (const double v : {lo, (lo + hi) / 2, hi}) out.emplace_back(v);
  } else if (info.kind == ValueKind::numbers && info.count > 0) {
    for (const double share : {0.0, 0.5, 1.0}) {
      std::vector<double> v = std::get<std::vector<double>>(info.init);
      for (double& x : v) {
        const auto [lo, hi] = range(info, x);
        x = lo + share * (hi - lo);
      }
      out.emplace_back(std::move(v));
    }
  }
  return out;
}

class EveryLandformParameter : public testing::TestWithParam<const LandformType*> {};

TEST_P(EveryLandformParameter, ChangesWhatIsMade) {
  const LandformType& type = *GetParam();
  for (const ParamInfo& info : type.about.params) {
    const std::string key = type.about.name + "." + info.name;
    const std::vector<Value> values = values_of(info, key);
    EXPECT_GE(values.size(), 2u) << key << " needs values in telling()";
    std::set<std::uint64_t> trees;
    for (const auto& place : places()) {
      trees.clear();
      for (const Value& value : values) {
        Values set = info.only_with;
        if (const auto with = quick().find(type.about.name); with != quick().end())
          set.insert(with->second.begin(), with->second.end());
        set.insert_or_assign(info.name, check_value(info, value, key));
        if (const auto tree = made(type, place->land.site, set)) trees.insert(*tree);
      }
      if (trees.size() > 1) break;
    }
    // Where no values of other parameters bring the case about, it depends on the site, as `only` tells.
    const bool by_site = !info.only.empty() && info.only_with.empty();
    EXPECT_TRUE(trees.size() > 1 || by_site)
        << key << " changes nothing; " << (info.only.empty() ? "say where it does" : "only " + info.only);
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryLandformParameter,
                         testing::ValuesIn(all_landforms().begin(), all_landforms().end()),
                         [](const auto& test_case) {
                           std::string name = test_case.param->about.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace tafoni::landforms
