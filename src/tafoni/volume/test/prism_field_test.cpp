#include "tafoni/volume/prism_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/volume/test/random_tools.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

/// Columns as plain sorted lists; the truth.
class Columns {
 public:
  explicit Columns(const ColumnFrame& frame, float thinnest)
      : frame_(frame), thinnest_(thinnest), at_(frame.nx * frame.ny) {}

  std::vector<Matter>& at(int i, int j) { return at_[j * frame_.nx + i]; }

  /// Gives the columns that changed.
  ColumnBox apply(const Tool& tool, Edit mode) {
    ColumnBox changed;
    for (int j = 0; j < frame_.ny; ++j)
      for (int i = 0; i < frame_.nx; ++i) {
        const auto span = tool.column(frame_.x(i), frame_.y(j));
        if (!span) continue;
        const Matter cut{static_cast<float>(span->lo - frame_.origin.z),
                         static_cast<float>(span->hi - frame_.origin.z)};
        if (!(cut.bottom < cut.top)) continue;
        const std::vector<Matter> old = at(i, j);
        at(i, j) = mode == Edit::remove ? less(old, cut) : with(old, cut);
        if (at(i, j) != old) changed.expand(i, j);
      }
    return changed;
  }

 private:
  std::vector<Matter> less(const std::vector<Matter>& old, Matter cut) const {
    std::vector<Matter> out;
    for (Matter m : old) {
      const Matter lower{m.bottom, std::min(m.top, cut.bottom)};
      const Matter upper{std::max(m.bottom, cut.top), m.top};
      for (Matter part : {lower, upper})
        if (part.top - part.bottom >= thinnest_) out.push_back(part);
    }
    return out;
  }
  std::vector<Matter> with(std::vector<Matter> all, Matter added) const {
    all.push_back(added);
    std::sort(all.begin(), all.end(), [](Matter a, Matter b) { return a.bottom < b.bottom; });
    std::vector<Matter> out;
    for (Matter m : all) {
      if (!out.empty() && m.bottom <= out.back().top)
        out.back().top = std::max(out.back().top, m.top);
      else
        out.push_back(m);
    }
    std::erase_if(out, [&](Matter m) { return m.top - m.bottom < thinnest_; });
    return out;
  }

  ColumnFrame frame_;
  float thinnest_;
  std::vector<std::vector<Matter>> at_;
};

void expect_equal(const PrismFields& fields, Columns& truth, const ColumnBox& box) {
  for (int j = box.j0; j <= box.j1; ++j)
    for (int i = box.i0; i <= box.i1; ++i) {
      // column() reads the layers in order, so this is the order and the clamping of the layers as well.
      ASSERT_EQ(fields.column(i, j), truth.at(i, j)) << "column " << i << ", " << j;
      for (const Matter& m : truth.at(i, j)) ASSERT_GE(m.top - m.bottom, 1e-3f);
    }
}

PrismFields box_of_rock(const ColumnFrame& frame, float bottom, float top) {
  PrismFields fields(frame);
  const Matter all{bottom, top};
  for (int j = 0; j < frame.ny; ++j)
    for (int i = 0; i < frame.nx; ++i) fields.set_column(i, j, {&all, 1});
  return fields;
}

const ColumnFrame small{{100, -50, 20}, 0.5, 0.75, 18, 14};
const ColumnBox all_of_small{0, 0, 17, 13};

TEST(PrismFields, AgreesWithColumnsOverRandomTools) {
  PrismFields fields = box_of_rock(small, -2, 4);
  Columns truth(small, 1e-3f);
  for (int j = 0; j < small.ny; ++j)
    for (int i = 0; i < small.nx; ++i) truth.at(i, j) = {{-2, 4}};
  Random random(11);
  const Box3d room{{100, -50, 18}, {108.5, -40.25, 24}};
  std::int64_t splits = 0;
  int most = 0, deepest = 1;
  for (int n = 0; n < 100000; ++n) {
    const Tool tool = random_tool(random, room);
    // Now more is taken, now more is given.
    const bool remove = random.uniform() < (n / 2000 % 2 ? 0.3 : 0.7);
    const Edit mode = remove ? Edit::remove : Edit::add;
    const int before = fields.layers();
    const ColumnBox expected = truth.apply(tool, mode), changed = fields.apply(tool, mode);
    ASSERT_EQ(changed, expected) << n;
    ASSERT_NO_FATAL_FAILURE(expect_equal(fields, truth, changed)) << n;
    if (n % 500 == 0) {
      ASSERT_NO_FATAL_FAILURE(expect_equal(fields, truth, all_of_small)) << n;
    }
    splits += fields.layers() > before;
    most = std::max(most, fields.layers());
    deepest = std::max(deepest, fields.deepest());
    ASSERT_LE(fields.layers(), std::max(8, 2 * deepest)) << n;
  }
  EXPECT_GT(splits, 100);
  EXPECT_GT(most, 3);
}

TEST(PrismFields, EveryLayerHoldsMatterAndRowsAreInOrder) {
  PrismFields fields = box_of_rock(small, -2, 4);
  Random random(12);
  const Box3d room{{100, -50, 18}, {108.5, -40.25, 24}};
  for (int n = 0; n < 3000; ++n) {
    fields.apply(random_tool(random, room), random.uniform() < 0.5 ? Edit::remove : Edit::add);
    for (int l = 0; l < fields.layers(); ++l) {
      int active = 0;
      for (int j = 0; j < small.ny; ++j)
        for (int i = 0; i < small.nx; ++i) active += fields.active(l, i, j);
      ASSERT_GT(active, 0) << l << " of " << fields.layers();
    }
    for (int j = 0; j < small.ny; ++j)
      for (int i = 0; i < small.nx; ++i) {
        float below = -1e30f;
        for (int l = 0; l < fields.layers(); ++l) {
          if (!fields.active(l, i, j)) continue;
          const Matter p = fields.point(l, i, j);
          ASSERT_LT(below, p.bottom);
          ASSERT_LT(p.bottom, p.top);
          below = p.top;
        }
      }
  }
}

// [Boggus §3, figs. 3, 5].
TEST(PrismFields, TunnelsVerticallyAndHorizontally) {
  const ColumnFrame frame{{}, 1, 1, 21, 21};
  PrismFields fields = box_of_rock(frame, 0, 10);
  EXPECT_EQ(fields.layers(), 1);
  const ColumnBox shaft = fields.apply(Tool::box({4, 4, 5}, {1.5, 1.5, 9}), Edit::remove);
  EXPECT_EQ(shaft, (ColumnBox{3, 3, 5, 5}));
  EXPECT_EQ(fields.layers(), 1);
  EXPECT_FALSE(fields.active(0, 4, 4));
  EXPECT_TRUE(fields.active(0, 2, 4));

  const ColumnBox tunnel = fields.apply(Tool::box({10, 10, 5}, {50, 1.5, 1}), Edit::remove);
  EXPECT_EQ(tunnel, (ColumnBox{0, 9, 20, 11}));
  ASSERT_EQ(fields.layers(), 2);
  EXPECT_EQ(fields.point(0, 7, 10), (Matter{0, 4}));
  EXPECT_EQ(fields.point(1, 7, 10), (Matter{6, 10}));
  EXPECT_FALSE(fields.active(1, 7, 8));

  // A second tunnel elsewhere finds room in the layer above, one below the first needs a layer between.
  fields.apply(Tool::box({10, 16, 5}, {50, 1.5, 1}), Edit::remove);
  EXPECT_EQ(fields.layers(), 2);
  fields.apply(Tool::box({10, 10, 2}, {50, 1.5, 1}), Edit::remove);
  ASSERT_EQ(fields.layers(), 3);
  EXPECT_EQ(fields.point(1, 7, 10), (Matter{3, 4}));
  EXPECT_EQ(fields.point(2, 7, 10), (Matter{6, 10}));

  // Filling them frees the layers.
  fields.apply(Tool::box({10, 10, 5}, {50, 50, 5}), Edit::add);
  EXPECT_EQ(fields.layers(), 1);
  EXPECT_EQ(fields.column(4, 4), (std::vector<Matter>{{0, 10}}));

  // Matter that floats free has a layer of its own, and joins what it meets.
  fields.apply(Tool::sphere({10, 10, 14}, 2.2), Edit::add);
  EXPECT_EQ(fields.layers(), 2);
  fields.apply(Tool::box({10, 10, 12}, {3, 3, 2.1}), Edit::add);
  EXPECT_EQ(fields.layers(), 1);
  EXPECT_EQ(fields.column(10, 10).size(), 1u);
}

// Roofs over roofs, each found and lost at another place: the layers do not pile up.
TEST(PrismFields, LayersStayBoundedByNeed) {
  const ColumnFrame frame{{}, 1, 1, 40, 40};
  PrismFields fields = box_of_rock(frame, 0, 40);
  Random random(13);
  int deepest = 1;
  for (int n = 0; n < 20000; ++n) {
    const Vec3d c{random.uniform(0, 39), random.uniform(0, 39), random.uniform(0, 40)};
    fields.apply(Tool::sphere(c, random.uniform(0.6, 3)), n % 2 ? Edit::add : Edit::remove);
    deepest = std::max(deepest, fields.deepest());
    ASSERT_LE(fields.layers(), std::max(8, 2 * deepest)) << n;
  }
  const PrismFields before = fields;
  fields.pack();
  EXPECT_EQ(fields.layers(), fields.deepest());
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) ASSERT_EQ(fields.column(i, j), before.column(i, j));
}

TEST(PrismFields, CopiesAreSnapshots) {
  PrismFields fields = box_of_rock(small, -2, 4);
  const PrismFields before = fields;
  fields.apply(Tool::sphere({104, -45, 21}, 2), Edit::remove);
  EXPECT_EQ(before.layers(), 1);
  EXPECT_EQ(fields.layers(), 2);
  EXPECT_EQ(before.column(8, 6), (std::vector<Matter>{{-2, 4}}));
}

TEST(PrismFields, ReadsBeyondItsFrameAsNothing) {
  PrismFields fields = box_of_rock(small, -2, 4);
  fields.apply(Tool::sphere({104, -45, 21}, 2), Edit::remove);
  ColumnBlock block;
  fields.read({-2, -3, 20, 19}, block);
  for (int j = -3; j <= 19; ++j)
    for (int i = -2; i <= 20; ++i) {
      const auto here = block.at(i, j);
      const bool in = i >= 0 && j >= 0 && i < small.nx && j < small.ny;
      EXPECT_EQ(std::vector<Matter>(here.begin(), here.end()),
                in ? fields.column(i, j) : std::vector<Matter>{});
    }
}

TEST(PrismFields, RefusesWhatCannotBe) {
  EXPECT_THAT(error_of([&] { PrismFields({{}, 1, 1, 1, 5}); }), HasSubstr("1 x 5 columns cannot be"));
  EXPECT_THAT(error_of([&] { PrismFields({{}, 0, 1, 5, 5}); }), HasSubstr("spacing of 0 x 1 m cannot be"));
  EXPECT_THAT(error_of([&] {
                PrismFields({{}, 1, 1, 5, 5}, 0);
              }),
              HasSubstr("least thickness of 0 m cannot be"));
  PrismFields fields(small);
  const std::vector<Matter> crossed{{0, 2}, {1, 3}};
  EXPECT_THAT(error_of([&] { fields.set_column(0, 0, crossed); }),
              HasSubstr("the matter of column (0, 0) is out of order"));
  const std::vector<Matter> thin{{0, 2}, {3, 3.0001f}};
  fields.set_column(0, 0, thin);
  EXPECT_EQ(fields.column(0, 0), (std::vector<Matter>{{0, 2}}));
}

TEST(PrismFields, ColumnsThatAreSetFreeLayersToo) {
  PrismFields fields(small);
  const std::vector<Matter> three{{0, 1}, {2, 3}, {4, 5}};
  fields.set_column(3, 4, three);
  fields.set_column(5, 4, std::span(three).first(2));
  EXPECT_EQ(fields.layers(), 3);
  fields.set_column(3, 4, std::span(three).first(1));
  EXPECT_EQ(fields.layers(), 2);
  fields.set_column(5, 4, {});
  fields.set_column(3, 4, {});
  EXPECT_EQ(fields.layers(), 0);
}

}  // namespace
}  // namespace tafoni::volume
