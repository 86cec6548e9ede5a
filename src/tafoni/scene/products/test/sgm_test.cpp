#include "tafoni/scene/products/sgm.h"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::scene {
namespace {

constexpr double pi = 3.14159265358979323846;

Document example(const std::string& name) {
  return load_scene(TAFONI_SOURCE_DIR "/examples/" + name + ".toml");
}

/// One solid alone, `share` times the size in half width.
BuiltScene one_solid(const std::string& name, double size, double share) {
  Document document = example("grammar_experiment");
  Values& values = document.layers.at(0).values;
  values["solids"] = name;
  values["classic"] = std::int64_t{1};
  values["morphic"] = std::int64_t{0};
  values["per_shape"] = std::int64_t{1};
  values["spread"] = std::vector<double>{share, share};
  values["flat"] = 1.0;
  values["size"] = size;
  return build(document);
}

TEST(Sgm, ASolidsMeasuresAreTheTruthWithinTheStatedError) {
  constexpr double size = 2, half = 0.93 * size;           // off the lattice
  constexpr double tube = 0.4 * half, ring = half - tube;  // as a torus fills a box
  struct Known {
    const char* name;
    double volume, area, radius;  ///< the least radius of its surface; 0 for flat faces
  };
  for (const Known& known :
       {Known{"sphere", 4 * pi / 3 * half * half * half, 4 * pi * half * half, half},
        Known{"cube", 8 * half * half * half, 24 * half * half, 0},
        Known{"torus", 2 * pi * pi * ring * tube * tube, 4 * pi * pi * ring * tube, tube}}) {
    const BuiltScene scene = one_solid(known.name, size, 0.93);
    const int details[] = {8, 16, 32};
    for (const SgmMeasures& row : sgm_measures(scene, "", details)) {
      const double cell = size / row.detail;
      // Triangles are chords of 1.7 cells at most, crossings are off by the bend along one cell.
      const double sagitta = known.radius > 0 ? 0.5 * cell * cell / known.radius : 0;
      // Flat faces are exact; edges are cut off by less than a cell and a half each way.
      const double edges = known.radius > 0 ? 0 : 12 * 2 * half;
      EXPECT_NEAR(row.volume, known.volume, known.area * sagitta + edges * 0.5 * 2.25 * cell * cell)
          << known.name << row.detail;
      EXPECT_NEAR(
          row.area, known.area,
          (known.radius > 0 ? 2 * known.area * sagitta / known.radius : 0) + edges * 0.586 * 1.5 * cell)
          << known.name << row.detail;
      EXPECT_LT(row.cubes.volume(), known.volume);
      EXPECT_GT(row.cubes.volume(), known.volume - known.area * cell);
      EXPECT_TRUE(row.closed);
      EXPECT_EQ(row.elements, 1);
      EXPECT_EQ(row.productions, 1);
      EXPECT_GT(row.seconds, 0);
    }
  }
}

TEST(Sgm, TheExperimentConverges) {
  const BuiltScene scene = build(example("grammar_experiment"));
  const int details[] = {4, 8, 16, 32};
  const auto rows = sgm_measures(scene, "grammar-cave", details);
  ASSERT_EQ(rows.size(), 4u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].detail, details[i]);
    EXPECT_EQ(rows[i].productions, 10 + 2);
    EXPECT_EQ(rows[i].elements, 3 * (10 + 2));
    if (i == 0) continue;
    EXPECT_GT(rows[i].cubes.volume(), rows[i - 1].cubes.volume());
    EXPECT_GT(rows[i].triangles, 3 * rows[i - 1].triangles);
    if (i < 2) continue;
    const auto step = [&](double SgmMeasures::*what, std::size_t k) {
      return std::abs(rows[k].*what - rows[k - 1].*what);
    };
    EXPECT_LT(step(&SgmMeasures::volume, i), 0.6 * step(&SgmMeasures::volume, i - 1));
    EXPECT_LT(step(&SgmMeasures::area, i), 0.75 * step(&SgmMeasures::area, i - 1));
  }
}

TEST(Sgm, CavesAreAsConvexAsTheDocumentSays) {
  for (const char* name : {"grammar_cave", "grammar_chambers", "grammar_shafts", "grammar_experiment"}) {
    const auto rows = sgm_measures(build(example(name)), "", {});
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].detail, 10);
    EXPECT_GT(rows[0].convexity.factor(), 40) << name;
    EXPECT_LT(rows[0].convexity.factor(), 75) << name;
    EXPECT_TRUE(rows[0].closed) << name;
  }
}

TEST(Sgm, MeasuresAMesh) {
  const std::filesystem::path file = TAFONI_SOURCE_DIR "/tests/data/ring_cave.off";
  const SgmMeasures m = sgm_measures(io::read_mesh(file), 0.6);
  EXPECT_NEAR(m.area, 7352.59, 0.05);
  EXPECT_NEAR(m.volume, 21144.72, 0.05);
  EXPECT_FALSE(m.elements);
  EXPECT_LT(m.cubes.volume(), m.volume);
  EXPECT_GT(m.cubes.volume(), m.volume - 0.6 * m.area);
}

TEST(Sgm, SaysWhatItCannotMeasure) {
  const auto message = [](const BuiltScene& scene, const std::string& layer) -> std::string {
    try {
      sgm_measures(scene, layer, {});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "";
  };
  Document document = example("grammar_experiment");
  EXPECT_THAT(message(build(document), "hall"), testing::HasSubstr("no grammar-cave layer \"hall\""));
  document.layers.clear();
  EXPECT_THAT(message(build(document), ""), testing::HasSubstr("no grammar-cave layer to measure"));
}

}  // namespace
}  // namespace tafoni::scene
