// A mask is read as an elevation model is, but for what its numbers mean.

#include "tafoni/io/mask.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/dem_frame.h"
#include "tafoni/io/impl/dem_levels.h"

namespace tafoni::io {
namespace {

constexpr float byte_white = 255, word_white = 65535;
/// A greatest weight below this is said to be small.
constexpr float little = 0.5f;

/// What the numbers of a file are divided by.
float white_of(const impl::DemSource& source, float greatest) {
  if (!source.whole || greatest <= 1) return 1;
  if (greatest > word_white)
    fail(ErrorKind::input,
         "{} is no mask: it holds whole numbers up to {:g}; weights are 0 to 1, or shares of 255 or 65535.",
         source.name, greatest);
  return greatest > byte_white || source.stored_type == GDT_UInt16 ? word_white : byte_white;
}

void note_numbers(const impl::DemSource& source, float greatest, float white,
                  std::vector<std::string>& notes) {
  if (source.whole && white > 1 && greatest < little * white)
    notes.push_back(
        fmt::format("its greatest number is {:g}, so that it weighs {:.2g} at most; {:g} or 1 alone is all.",
                    greatest, greatest / white, white));
  else if (!source.whole && greatest > 1)
    notes.push_back(fmt::format("holds numbers up to {:g}; what is above 1 counts as 1.", greatest));
}

}  // namespace

MaskFile read_mask(const std::filesystem::path& path, const std::string& crs, Progress& progress) {
  DemOptions options;
  options.encoding = HeightEncoding::heights;
  options.crs = crs;
  const auto source = impl::DemSource::open(path, options);
  source->guess_marks = false;
  source->scale = source->unit = 1;
  source->offset = 0;
  const int width = source->width(), height = source->height();
  if (width < 2 || height < 2)
    fail(ErrorKind::input, "{} is {} x {} pixels; a mask needs at least 2 x 2.", source->name, width, height);
  impl::check_memory(1.0 * width * height, 2, source->name);
  const std::array<int, 4> window{0, 0, width, height};
  const impl::Frame frame = impl::metric_frame(*source, window, options);
  raster::Grid<float> weights = impl::read_window(*source, window, 1, 1, width, height, progress).heights;

  float greatest = 0;
  for (const float w : weights.values()) greatest = w > greatest ? w : greatest;
  const float white = white_of(*source, greatest);
  MaskFile out;
  out.placed = source->georeferenced;
  if (out.placed) out.notes = frame.notes;
  note_numbers(*source, greatest, white, out.notes);
  for (float& w : weights.values()) w /= white;
  out.raster = frame.reproject || frame.rotated
                   ? impl::warp(weights, frame.transform, frame, std::min(frame.pixel_x, frame.pixel_y),
                                source->name, progress)
                   : impl::upright(std::move(weights), frame.transform);
  for (std::string& note : out.notes) {
    note = fmt::format("mask {}: {}", source->name, note);
    progress.warn(note);
  }
  return out;
}

}  // namespace tafoni::io
