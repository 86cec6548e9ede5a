#include "tafoni/scene/sculpt/brush.h"

#include <gmock/gmock.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/compiled.h"
#include "tafoni/scene/sculpt/impl/sculpt.h"

namespace tafoni::scene {
namespace {

constexpr double amplitude = 5;

/// What one stroke makes of rock (f = T) or air (f = -T) that has no end.
class Made {
 public:
  explicit Made(const std::string& line, double below = amplitude) {
    const impl::Slot slot{std::make_shared<Stroke>(parse_stroke(line, "test")), false};
    impl::SculptFrame frame;
    frame.amplitude = amplitude;
    const auto cooked = cook_.cook({&slot, 1}, frame).value;
    changed_boxes(nullptr, cooked.get(), boxes);
    field_ = std::make_unique<field::CompiledField>(
        field::compile(field::blend({field::constant(static_cast<float>(below)), cooked->node})));
  }
  float operator()(Vec3d p) const { return field_->value(p); }

  std::vector<Box3d> boxes;

 private:
  impl::SculptCook cook_;
  std::unique_ptr<field::CompiledField> field_;
};

class EveryBrush : public ::testing::TestWithParam<const BrushType*> {};

TEST_P(EveryBrush, ActsInItsBoxAloneAndTheSameEachTime) {
  const BrushType& brush = *GetParam();
  EXPECT_FALSE(brush.about.doc.empty());
  EXPECT_FALSE(brush.about.source.empty());
  ASSERT_NE(brush.apply == nullptr, brush.paint == nullptr);
  if (!brush.apply) return;
  for (const std::string mode : {"carve", "add"}) {
    std::string line = brush.about.name + " mode=" + mode + " radius=3 roughness=0.5 at=0,0,0";
    for (std::size_t i = 1; i < brush.min_points; ++i) line += "/12,3,2";
    const Made made(line), again(line);
    ASSERT_EQ(made.boxes.size(), 1u);
    const Box3d box = made.boxes[0];
    Random random(4);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      const Box3d wide = box.grown(6);
      const Vec3d p{random.uniform(wide.lo.x, wide.hi.x), random.uniform(wide.lo.y, wide.hi.y),
                    random.uniform(wide.lo.z, wide.hi.z)};
      const float f = made(p);
      EXPECT_EQ(f, again(p));
      if (!box.contains(p)) {
        EXPECT_EQ(f, static_cast<float>(amplitude));
      }
      EXPECT_TRUE(mode == "add" ? f >= static_cast<float>(amplitude) : f <= static_cast<float>(amplitude));
      inside += mode == "add" ? f > 2 * amplitude : f < 0;
    }
    EXPECT_GT(inside, 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryBrush,
                         ::testing::ValuesIn(all_brushes().begin(), all_brushes().end()),
                         [](const auto& brush) { return brush.param->about.name; });

TEST(Brush, AnArchStandsOnItsFeetOverAnOpening) {
  const Made arch("arch mode=add at=-15,0,0/15,0,0 radius=2 height=10", -amplitude);
  EXPECT_GT(arch({0, 0, 12}), 0);
  EXPECT_GT(arch({-15, 0, 0}), 0);
  EXPECT_LT(arch({0, 0, 8}), 0);
  EXPECT_LT(arch({0, 0, 16}), 0);
}

TEST(Brush, AnOpeningGoesThroughTheWall) {
  const Made gate("arch at=-6,0,0/6,0,0 radius=3 height=12 depth=30 roughness=0");
  for (double y = -14; y <= 14; y += 2) {
    EXPECT_LT(gate({0, y, 1.5}), 0);
    EXPECT_LT(gate({0, y, 10.5}), 0);
    EXPECT_LT(gate({-4.5, y, 3}), 0);
    EXPECT_GT(gate({-7.5, y, 3}), 0);
    EXPECT_GT(gate({-6, y, 11}), 0);
    EXPECT_GT(gate({0, y, 13.5}), 0);
  }
}

TEST(Brush, ACaveCanBeWalkedThrough) {
  for (int seed = 0; seed < 5; ++seed) {
    const Made cave("cave at=0,0,0/30,10,4/60,0,0 radius=3 chambers=1 wander=0 seed=" + std::to_string(seed));
    const Vec3d points[] = {{0, 0, 0}, {30, 10, 4}, {60, 0, 0}};
    for (const Vec3d p : sample_path(points, true, 0.5)) EXPECT_LT(cave(p), 0);
  }
}

TEST(Brush, StrokesOfTooManyBallsAreRefusedAtOnce) {
  std::string far = "curve radius=0.1 at=0,0,0";
  for (int i = 0; i < 1000; ++i) far += i % 2 ? "/0,0,0" : "/100000,0,0";
  for (const std::string& line :
       {far, std::string("arch radius=0.01 at=0,0,0/30,0,0 height=10000 depth=10000"),
        std::string("arch at=-1e9,0,0/1e9,0,0"), std::string("arch at=-1e9,-1e9,0/1e9,1e9,0 height=10000")})
    EXPECT_THAT(error_of([&] { Made{line}; }), ::testing::HasSubstr("balls, and at most 2 million are made"));
  // A single point in the wrong place stops no build.
  EXPECT_EQ(error_of([&] { Made{"curve at=0,0,0/1e9,0,0"}; }), "");
}

TEST(Brush, RoughnessIsNoBall) {
  // The surface's distance from the centre varies with roughness and not without.
  const auto spread = [](const std::string& roughness) {
    const Made ball("sphere at=0,0,0 radius=8 roughness=" + roughness);
    Random random(2);
    double lo = 1e9, hi = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3d u = normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
      double a = 0, b = 20;
      while (b - a > 1e-3) (ball(u * (0.5 * (a + b))) < 0 ? a : b) = 0.5 * (a + b);
      lo = std::min(lo, a);
      hi = std::max(hi, a);
    }
    return std::pair(lo, hi);
  };
  const auto smooth = spread("0"), rough = spread("0.4");
  EXPECT_NEAR(smooth.first, 8, 0.02);
  EXPECT_NEAR(smooth.second, 8, 0.02);
  EXPECT_GT(rough.second - rough.first, 1.5);
}

}  // namespace
}  // namespace tafoni::scene
