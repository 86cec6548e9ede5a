#include "tafoni/io/mask.h"

#include <gmock/gmock.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/io/test/dem_inputs.h"

namespace tafoni::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Four pixels of a file of one row of four numbers, twice.
std::vector<float> weights(const Tiff& tiff, std::array<double, 4> numbers, MaskFile* read = nullptr) {
  Tiff small = tiff;
  small.width = 4, small.height = 2;
  const fs::path path = temporary("mask.tif");
  write_tiff(path, small, [&](int c, int) { return numbers[c]; });
  const MaskFile mask = read_mask(path, "");
  if (read) *read = mask;
  const float* row = mask.raster.values.row(0);
  return {row, row + 4};
}

TEST(Mask, GreysAreSharesOfWhite) {
  const Tiff bytes{.type = GDT_Byte}, words{.type = GDT_UInt16};
  EXPECT_THAT(weights(bytes, {0, 51, 102, 255}), ElementsAre(0, 0.2f, 0.4f, 1));
  EXPECT_THAT(weights(words, {0, 13107, 26214, 65535}), ElementsAre(0, 0.2f, 0.4f, 1));
  EXPECT_THAT(weights(bytes, {0, 1, 1, 0}), ElementsAre(0, 1, 1, 0));
  EXPECT_THAT(weights({.type = GDT_Int16}, {0, 51, 255, 0}), ElementsAre(0, 0.2f, 1, 0));
  EXPECT_THAT(weights({}, {0, 0.25, 1, 0.5}), ElementsAre(0, 0.25f, 1, 0.5f));
}

TEST(Mask, OnlyTaggedNumbersAreMissing) {
  const std::vector<float> tagged = weights({.type = GDT_Byte, .nodata = 255}, {0, 1, 255, 1});
  EXPECT_TRUE(std::isnan(tagged[2]));
  EXPECT_EQ(tagged[1], 1);
  EXPECT_THAT(weights({.type = GDT_UInt16}, {65535, 65535, 65535, 65535}), ElementsAre(1, 1, 1, 1));
}

TEST(Mask, OddNumbersAreToldOf) {
  MaskFile mask;
  weights({.type = GDT_Byte}, {0, 1, 2, 3}, &mask);
  EXPECT_THAT(mask.notes, ElementsAre(HasSubstr("weighs 0.012 at most; 255 or 1 alone is all")));
  weights({}, {0, 0.5, 7, 3}, &mask);
  EXPECT_THAT(mask.notes, ElementsAre(HasSubstr("numbers up to 7; what is above 1 counts as 1")));
  weights({.type = GDT_Byte}, {0, 128, 255, 3}, &mask);
  EXPECT_THAT(mask.notes, IsEmpty());
  EXPECT_THAT(error_of([] { weights({.type = GDT_Int32}, {0, 70000, 0, 0}); }), HasSubstr("is no mask"));
}

TEST(Mask, LiesWhereItsFileSaysOrNowhere) {
  MaskFile mask;
  weights({.type = GDT_Byte}, {0, 1, 1, 0}, &mask);
  EXPECT_TRUE(mask.placed);
  EXPECT_EQ(mask.raster.placement.west, 411000);
  EXPECT_EQ(mask.raster.placement.dx, 10);
  weights({.type = GDT_Byte, .transform = std::nullopt}, {0, 1, 1, 0}, &mask);
  EXPECT_FALSE(mask.placed);
  EXPECT_THAT(mask.notes, IsEmpty());
}

}  // namespace
}  // namespace tafoni::io
