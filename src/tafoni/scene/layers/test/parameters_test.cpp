// Every parameter of every brush and of every layer that is no landform, at both ends and in the middle of
// its range: it changes what is made, or its declaration says where alone it does.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/field/primitive.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/layers/layer.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

namespace fs = std::filesystem;

/// Both ends of its range and the middle, or all that it can be; empty for a text.
std::vector<Value> values_of(const ParamInfo& info) {
  switch (info.kind) {
    case ValueKind::boolean:
      return {false, true};
    case ValueKind::integer:
      return {static_cast<std::int64_t>(info.min), static_cast<std::int64_t>((info.min + info.max) / 2),
              static_cast<std::int64_t>(info.max)};
    case ValueKind::real:
      return {info.min, (info.min + info.max) / 2, info.max};
    case ValueKind::choice:
      return {info.choices.begin(), info.choices.end()};
    case ValueKind::numbers: {
      std::vector<Value> out;
      for (const double v : {info.min, (info.min + info.max) / 2, info.max})
        out.emplace_back(std::vector<double>(info.count, v));
      return out;
    }
    default:
      return {};
  }
}

/// Asks that `make` gives another thing for each value that is not the default.
template <class Make>
void expect_change(const ParamInfo& info, std::vector<Value> values, const std::string& owner, Make make) {
  if (values.empty()) values = values_of(info);
  ASSERT_FALSE(values.empty()) << owner << "." << info.name;
  std::erase(values, info.init);
  const auto plain = make(info.only_with);
  for (const Value& value : values) {
    Values all = info.only_with;
    all[info.name] = value;
    EXPECT_TRUE(make(all) != plain) << owner << "." << info.name << " = " << to_toml(value);
  }
}

/// All that a brush adds, as numbers.
class Recorder : public Dab {
 public:
  void add(std::string_view kind, Vec3d anchor, double radius, std::span<const float> extras) override {
    for (const char c : kind) all.push_back(c);
    all.insert(all.end(), {anchor.x, anchor.y, anchor.z, radius});
    all.insert(all.end(), extras.begin(), extras.end());
  }
  std::vector<double> all;
};

std::pair<std::vector<double>, std::string> made_by(const BrushType& brush, const Values& values) {
  Stroke stroke;
  stroke.brush = brush.about.name;
  stroke.points = {{0, 0, 0}, {18, 5, 2}, {30, -4, 0}};
  stroke.points.resize(std::min<std::size_t>(3, brush.max_points));
  for (const auto& [name, value] : values) {
    const auto own = params_of_brush(brush, values);
    if (std::any_of(own.begin(), own.end(),
                    [&, n = name](const ParamInfo& info) { return info.name == n; })) {
      stroke.values[name] = value;
    } else {
      const ParamInfo& info = find_param(stroke_params(), name, "test");
      info.store(info, &stroke, value);
    }
  }
  Recorder recorder;
  if (brush.apply) brush.apply(stroke, 7, recorder);
  if (!brush.paint) return {recorder.all, ""};
  const Painting painting = brush.paint(stroke);
  return {{painting.hardness, painting.erase ? 1.0 : 0.0}, painting.mask};
}

TEST(Parameters, OfEveryBrushDoSomething) {
  for (const BrushType* brush : all_brushes())
    for (const ParamInfo& info : brush->about.params) {
      std::vector<Value> values;
      if (info.name == "mask") values = {std::string("other")};
      if (info.name == "kind")
        for (const field::PrimitiveType* kind : field::all_primitives())
          values.emplace_back(kind->about.name);
      expect_change(info, values, brush->about.name, [&](const Values& all) { return made_by(*brush, all); });
    }
}

class LayerParameters : public ::testing::Test {
 protected:
  void SetUp() override {
    // A body without volume and one with, both so large that every noise is less than their radius.
    std::ofstream(root / "p.csv") << "kind,x,y,z,radius,energy\npoint,40,30,20,2000,-3\n"
                                     "sphere,1560,30,20,1500,-2\n";
    std::ofstream(root / "deep.csv") << "kind,x,y,z,radius,energy\npoint,40,30,0,20,-30\n";
    std::ofstream(root / "a.strokes") << "sphere at=40,30,10 radius=6\n";
    const volume::GridFrame frame{{-20, -20, -20}, 2, {21, 21, 21}};
    io::Volume ball{volume::ScalarGrid(frame, -6), {40, 30, 10}, {}};
    ball.grid.edit(ball.grid.samples(), [&](Vec3i first, std::span<float> row) {
      for (int i = 0; i < std::ssize(row); ++i)
        row[i] =
            static_cast<float>(std::clamp(12 - length(frame.position(first + Vec3i{i, 0, 0})), -6.0, 6.0));
    });
    io::write_volume(root / "ball.tvol", ball);
  }

  std::vector<float> field_with(const std::string& type, const Values& files, const Values& values) const {
    Document document;
    document.directory = root;
    document.scene.voxel = 2;
    document.terrain.generator = "coast";
    document.terrain.values = {{"width", std::int64_t{32}}, {"height", std::int64_t{24}}, {"pixel", 2.0}};
    Layer below, layer;
    below.type = "primitives";
    below.values = {{"file", std::string("deep.csv")}};
    layer.type = type;
    layer.values = files;
    for (const auto& [name, value] : values) layer.values[name] = value;
    document.layers = {below, layer};
    const BuiltScene scene = build(document);
    Random random(5);
    std::vector<Vec3d> points;
    for (int i = 0; i < 400; ++i)
      points.push_back(
          scene.terrain.to_local({random.uniform(15, 60), random.uniform(10, 45), random.uniform(-15, 35)}));
    std::vector<float> out(points.size());
    scene.field_for(surface::Boundary::open).values(points, out);
    return out;
  }

  const TestFolder folder;
  const fs::path root = folder.path;
};

TEST_F(LayerParameters, DoSomething) {
  const std::map<std::string, Values> needed = {{"primitives", {{"file", std::string("p.csv")}}},
                                                {"sculpt", {{"strokes", std::string("a.strokes")}}},
                                                {"volume", {{"file", std::string("ball.tvol")}}}};
  for (const LayerKind* kind : all_layers()) {
    if (!kind->listed_as.empty()) continue;  // a registry of its own, with tests of its own
    for (const LayerType& type : kind->types) {
      ASSERT_TRUE(needed.contains(type.about.name))
          << type.about.name << " wants a row in `needed` to be tried with";
      const std::set<std::string> paths(type.paths.begin(), type.paths.end());
      for (const ParamInfo& info : type.about.params)
        if (!paths.contains(info.name))
          expect_change(info, {}, type.about.name, [&](const Values& values) {
            return field_with(type.about.name, needed.at(type.about.name), values);
          });
    }
  }
}

TEST_F(LayerParameters, FilesAreWhatTheRegistrySays) {
  for (const LayerType* type : all_layer_types())
    for (const std::string& name : type->paths)
      EXPECT_EQ(find_param(type->about.params, name, type->about.name).kind, ValueKind::text);
}

}  // namespace
}  // namespace tafoni::scene
