#include "tafoni/raster/jumps.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tafoni::raster {
namespace {

Jumps jumps_of(const std::vector<std::vector<float>>& rows, double limit) {
  JumpSearch search(limit);
  for (const auto& row : rows) search.add(row);
  return search.jumps();
}

TEST(JumpSearch, CountsNeighboursAcrossEdges) {
  // A pit has four neighbours, one in a corner two; the greatest step is told where it is.
  const Jumps pit = jumps_of({{1, 1, 1}, {1, -500, 1}, {1, 1, 1}}, 100);
  EXPECT_EQ(pit.count, 4u);
  EXPECT_EQ(pit.height, 501);
  EXPECT_EQ(pit.row, 1);
  const Jumps corner = jumps_of({{1, 1, 1}, {1, 1, 1}, {1, 150, 900}}, 200);
  EXPECT_EQ(corner.count, 2u);
  EXPECT_EQ(corner.height, 899);
  EXPECT_EQ(corner.col, 2);
  EXPECT_EQ(corner.row, 2);
}

TEST(JumpSearch, RowsThatAreSkippedAreNoNeighbours) {
  JumpSearch search(100);
  search.add(std::vector<float>{0, 0});
  search.skip(3);
  search.add(std::vector<float>{900, 900});
  EXPECT_EQ(search.jumps().count, 0u);
  search.add(std::vector<float>{900, 0});
  EXPECT_EQ(search.jumps().count, 2u);
  EXPECT_EQ(search.jumps().row, 5);
}

TEST(JumpSearch, SlopesAndMissingDataAreNone) {
  EXPECT_EQ(jumps_of({{0, 100, 200}, {100, 200, 300}}, 100).count, 0u);
  EXPECT_EQ(jumps_of({{0, NAN, 5000}, {0, NAN, 5000}}, 100).count, 0u);
  EXPECT_EQ(jumps_of({{7}}, 0).count, 0u);
}

}  // namespace
}  // namespace tafoni::raster
