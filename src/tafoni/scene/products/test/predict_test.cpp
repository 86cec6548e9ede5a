#include "tafoni/scene/products/predict.h"

#include <gtest/gtest.h>

#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::scene {
namespace {

/// How far off a prediction is, as a part of what a build makes.
double triangles_off(const std::string& text, double* share = nullptr) {
  const BuiltScene scene = build(parse_scene(text, "s.toml"));
  const Prediction predicted = predict(scene);
  if (share) *share = predicted.share;
  const MeshResult made = mesh_scene(scene);
  return static_cast<double>(predicted.triangles) / static_cast<double>(made.mesh.triangles.size()) - 1;
}

std::string coast(int width, int height, const std::string& scene, const std::string& layers = "") {
  return "[scene]\n" + scene + "[terrain]\ngenerator = \"coast\"\nwidth = " + std::to_string(width) +
         "\nheight = " + std::to_string(height) + "\npixel = 2\n" + layers;
}

TEST(Prediction, OfASmallSceneIsWhatIsMade) {
  const std::string karst = "[[layer]]\ntype = \"karst\"\n";
  EXPECT_NEAR(triangles_off(coast(100, 80, "voxel = 1\n", karst)), 0, 0.001);
  EXPECT_NEAR(triangles_off(coast(100, 80, "voxel = 1\nboundary = \"open\"\n", karst)), 0, 0.001);
  EXPECT_NEAR(triangles_off(coast(100, 80, "voxel = 1\nsimplify = 0.5\n", karst)), 0, 0.001);
}

TEST(Prediction, OfALargerOneIsNear) {
  const std::string cliffs = "[[layer]]\ntype = \"sea-cliff\"\n";
  double share = 1;
  EXPECT_NEAR(triangles_off(coast(360, 350, "voxel = 1\n", cliffs), &share), 0, 0.05);
  EXPECT_LT(share, 0.8);
  EXPECT_NEAR(triangles_off(coast(360, 350, "voxel = 1\nboundary = \"open\"\n")), 0, 0.05);
}

TEST(Prediction, OfASimplifiedOneIsNear) {
  // What is looked at is cut out of the terrain, and the cut is not simplified.
  double share = 1;
  EXPECT_NEAR(triangles_off(coast(310, 300, "voxel = 1\nboundary = \"open\"\nsimplify = 0.1\n"), &share), 0,
              0.05);
  EXPECT_LT(share, 1);
  // Of a plane little but its border is left, and what the seams of patches leave, which is not foreseen.
  const std::string plane =
      "[scene]\nvoxel = 1\nboundary = \"open\"\nsimplify = 0.5\n"
      "[terrain]\ngenerator = \"plane\"\nwidth = 700\nheight = 700\n";
  EXPECT_NEAR(triangles_off(plane), 0, 0.35);
}

TEST(Prediction, OfWhatStandsHighAboveTheGround) {
  const std::string scene =
      "scene = { voxel = 0.2, min_fragment = 0 }\n"
      "terrain = { generator = \"plane\", elevation = -60, width = 128, height = 128 }\n"
      "layer = [{ type = \"grammar-cave\", mode = \"solid\", alone = true, at = [64, 64, 0], size = 2.0 }]\n";
  double share = 1;
  EXPECT_NEAR(triangles_off(scene, &share), 0, 0.05);
  EXPECT_LT(share, 0.2);
}

TEST(Prediction, OfWhatNobodyCanBuildTakesNoTime) {
  const BuiltScene scene = build(parse_scene(coast(400, 300, "voxel = 0.01\n"), "s.toml"));
  const Prediction p = predict(scene);
  // 800 m by 600 m, top and base, two triangles a cell, and more for slopes and walls.
  EXPECT_GT(static_cast<double>(p.triangles), 4 * 80e3 * 60e3);
  EXPECT_LT(static_cast<double>(p.triangles), 12 * 80e3 * 60e3);
  EXPECT_LT(least_prediction(scene).triangles, p.triangles);
  EXPECT_GT(p.memory, p.file_bytes);
  EXPECT_LT(predict(scene, 4).memory, p.memory / 15);
}

TEST(Prediction, OfATallSceneHasItsWalls) {
  const std::string plane = "[scene]\nvoxel = 1\n[terrain]\ngenerator = \"plane\"\nwidth = 40\nheight = 40\n";
  const BuiltScene flat = build(parse_scene(plane, "s.toml")),
                   tall = build(parse_scene(plane + "depth = 400\n", "s.toml"));
  EXPECT_FALSE(is_tall(flat));
  EXPECT_TRUE(is_tall(tall));
  for (const BuiltScene* scene : {&flat, &tall}) {
    const auto least = static_cast<double>(least_prediction(*scene).triangles),
               made = static_cast<double>(predict(*scene).triangles);
    EXPECT_LT(least, made);
    EXPECT_GT(least, 0.7 * made);
  }
  const BuiltScene tower = build(parse_scene(plane + "depth = 100000\n", "s.toml"));
  EXPECT_GT(least_prediction(tower).triangles, 10000000u);
}

}  // namespace
}  // namespace tafoni::scene
