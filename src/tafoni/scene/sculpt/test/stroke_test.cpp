#include "tafoni/scene/sculpt/stroke.h"

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

using ::testing::HasSubstr;

template <class F>
std::string failure(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string wrong(std::string_view line) {
  return failure([&] { parse_stroke(line, "here"); });
}

/// A stroke of any brush with random values.
Stroke any_stroke(Random& random) {
  const auto brushes = all_brushes();
  const BrushType& brush = *brushes[random.below(brushes.size())];
  Stroke s;
  s.brush = brush.about.name;
  const std::size_t most = std::min<std::size_t>(brush.max_points, brush.min_points + 3);
  const std::size_t n = brush.min_points + random.below(most - brush.min_points + 1);
  for (std::size_t i = 0; i < n; ++i)
    s.points.push_back(
        {random.uniform(-1e6, 1e6), random.uniform(-1, 1), static_cast<double>(random.below(100))});
  if (random.below(2)) s.mode = "add";
  s.radius = random.uniform(0.01, 100);
  s.roughness = random.uniform(0, 0.6);
  s.seed = static_cast<std::int64_t>(random.below(1000));
  for (const ParamInfo& info : params_of_brush(brush, s.values)) {
    Value value = info.init;
    if (info.kind == ValueKind::real) value = random.uniform(info.min, info.max);
    if (info.kind == ValueKind::boolean) value = random.below(2) == 0;
    if (info.kind == ValueKind::text && info.name == "mask") value = " a name = with blanks\t";
    if (value != info.init) s.values[info.name] = value;
  }
  return s;
}

TEST(Stroke, SurvivesItsText) {
  Random random(11);
  for (int i = 0; i < 500; ++i) {
    const Stroke s = any_stroke(random);
    EXPECT_EQ(parse_stroke(to_text(s), "round trip"), s) << to_text(s);
  }
}

TEST(Stroke, ReadsALine) {
  const Stroke s = parse_stroke("cave  at=1,2,3/4,5,6.5 radius=2 chambers=1 mode=add", "here");
  EXPECT_EQ(s.brush, "cave");
  ASSERT_EQ(s.points.size(), 2u);
  EXPECT_EQ(s.points[1], (Vec3d{4, 5, 6.5}));
  EXPECT_EQ(s.radius, 2);
  EXPECT_TRUE(s.adds());
  EXPECT_EQ(std::get<std::int64_t>(s.values.at("chambers")), 1);
  EXPECT_EQ(parse_stroke("sphere at=1,2,3 at=4,5,6", "here").points.size(), 2u);
  // A kind's own shape are parameters of the skeletal brush.
  EXPECT_EQ(parse_stroke("skeletal kind=segment at=0,0,0 dx=4", "here").values.count("dx"), 1u);
}

TEST(Stroke, SaysWhatIsWrong) {
  EXPECT_THAT(wrong(""), HasSubstr("is empty"));
  EXPECT_THAT(wrong("spere at=1,2,3"), HasSubstr("did you mean \"sphere\"?"));
  EXPECT_THAT(wrong("sphere"), HasSubstr("takes at least 1 point"));
  EXPECT_THAT(wrong("arch at=1,2,3"), HasSubstr("takes 2 points, not 1"));
  EXPECT_THAT(wrong("sphere at=1,2"), HasSubstr("must be X,Y,Z"));
  EXPECT_THAT(wrong("sphere at=1,2,nan"), HasSubstr("must be X,Y,Z"));
  EXPECT_THAT(wrong("sphere at=1,2,3 radius=0"), HasSubstr("radius = 0 is outside"));
  EXPECT_THAT(wrong("sphere at=1,2,3 radius"), HasSubstr("must be NAME=VALUE"));
  EXPECT_THAT(wrong("sphere at=1,2,3 raduis=4"), HasSubstr("did you mean \"radius\"?"));
  EXPECT_THAT(wrong("sphere at=1,2,3 mode=\"add"), HasSubstr("quote is not closed"));
  EXPECT_THAT(wrong("sphere at=1e12,2,3"), HasSubstr("no position in metres"));
  EXPECT_THAT(wrong("skeletal at=1,2,3 kind=blob"), HasSubstr("blob"));
}

TEST(StrokeFile, HoldsOneALineOrJson) {
  const auto text = parse_strokes("# two\n\nsphere at=1,2,3\r\n  cave at=1,2,3 radius=2\n", "f");
  ASSERT_EQ(text.size(), 2u);
  const auto json = parse_strokes(
      R"([{"brush": "sphere", "at": [1, 2, 3]}, {"brush": "cave", "radius": 2, "at": [[1, 2, 3]]}])", "f");
  EXPECT_EQ(json, text);
  const auto kind =
      parse_strokes(R"({"dx": 3, "brush": "skeletal", "at": [0, 0, 0], "kind": "segment"})", "f");
  EXPECT_EQ(std::get<double>(kind.at(0).values.at("dx")), 3);
  EXPECT_TRUE(parse_strokes("", "f").empty());
}

TEST(StrokeFile, NamesTheLine) {
  EXPECT_THAT(failure([] { parse_strokes("sphere at=1,2,3\nsphere at=1\n", "f.txt"); }),
              HasSubstr("f.txt:2: "));
  EXPECT_THAT(failure([] { parse_strokes("spher at=1,2,3\n", "f.txt"); }), HasSubstr("f.txt:1: "));
  EXPECT_THAT(failure([] { parse_strokes("[{\"brush\": \"sphere\"}]", "f.json"); }),
              HasSubstr("f.json: stroke 1"));
  EXPECT_THAT(failure([] { parse_strokes("[1", "f.json"); }), HasSubstr("is not valid JSON"));
}

}  // namespace
}  // namespace tafoni::scene
