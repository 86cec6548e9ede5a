#include <numbers>

#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/field/tree.h"

namespace tafoni::field {
namespace {

TEST(Coverage, OfDiscsInASquare) {
  CloudBuilder cloud{CloudSettings{}};
  add_point(cloud, {30, 30, 500}, 10, -1);
  add_point(cloud, {30, 30, -500}, 10, 2);
  add_point(cloud, {70, 60, 0}, 20, 1);
  add_point(cloud, {300, 0, 0}, 20, 1);
  const NodePtr tree = blend({constant(0), cloud.finish()});
  EXPECT_NEAR(coverage(tree, {{0, 0, 0}, {100, 100, 0}}, 0.1), std::numbers::pi * 500 / 10000, 1e-3);
  EXPECT_EQ(coverage(constant(1), {{0, 0, 0}, {100, 100, 0}}, 1), 0);
  EXPECT_EQ(error_of([&] {
              coverage(tree, {{0, 0, 0}, {100, 0, 0}}, 1);
            }),
            "coverage wants an area and a cell above 0 m");
}

TEST(Coverage, CountsEveryCopy) {
  CloudBuilder cloud{CloudSettings{}};
  add_point(cloud, {5, 0, 0}, 5, 1);
  const NodePtr shape = cloud.finish();
  const std::vector<Placement> places{{{20, 20, 0}, 1, 0, 1}, {{60, 50, 7}, -2, 0, 2}};
  const double share =
      coverage(unite({constant(-1), instances(shape, places)}), {{0, 0, 0}, {100, 100, 0}}, 0.1);
  EXPECT_NEAR(share, std::numbers::pi * 125 / 10000, 1e-3);
}

}  // namespace
}  // namespace tafoni::field
