// Pictures, read back by an independent reader.

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <stb_image.h>

#include "tafoni/io/image_file.h"

namespace tafoni::io {
namespace {

raster::Image gradient(int width, int height) {
  raster::Image image(width, height);
  for (int row = 0; row < height; ++row)
    for (int col = 0; col < width; ++col)
      image.at(col, row) = {static_cast<std::uint8_t>(255 * col / (width - 1)),
                            static_cast<std::uint8_t>(255 * row / (height - 1)), 90, 255};
  return image;
}

/// The greatest difference of any channel from what was written.
int worst_difference(const char* name) {
  const raster::Image image = gradient(160, 90);
  const auto path = std::filesystem::path(testing::TempDir()) / name;
  write_image(path, image);
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels = stbi_load(path.c_str(), &width, &height, &channels, 3);
  if (!pixels || width != image.width() || height != image.height()) return 1000;
  int worst = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(pixels[3 * i + c] - image.values()[i][c]));
  stbi_image_free(pixels);
  std::filesystem::remove(path);
  return worst;
}

TEST(Pictures, PngIsExact) {
  EXPECT_EQ(worst_difference("tafoni_pictures.png"), 0);
}

TEST(Pictures, JpegIsClose) {
  EXPECT_LE(worst_difference("tafoni_pictures.jpg"), 12);
  EXPECT_LE(worst_difference("tafoni_pictures.jpeg"), 12);
}

}  // namespace
}  // namespace tafoni::io
