// Rows of bare numbers: how many bits each has follows from the size of the file, and which byte of it comes
// first from the terrain, for in the wrong order neighbours jump about as if they were drawn by lot.

#include "tafoni/io/impl/raw_heights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

#include "tafoni/io/impl/stored_heights.h"
#include "tafoni/math/whole.h"

namespace tafoni::io::impl {
namespace {

/// Pixels a side beyond which a file is no heightmap but something else.
constexpr int most_raw_side = 1'000'000;
/// Rows that are looked at to tell the order of bytes.
constexpr int judged_rows = 64;
/// Neighbours differ by so much of what any two pixels differ by: below, a terrain is smooth; numbers drawn
/// by lot have 1. Of two orders the better one is so much smoother, or nothing tells them apart.
constexpr double smooth_raw = 0.5, clearly_smoother = 0.8;
/// A float of a heightmap is 0 or lies between these; others come from another order of bytes.
constexpr double least_float = 1e-12, largest_float = 1e6;

/// How the numbers of a file are laid out.
struct Layout {
  int width = 0, height = 0;
  int bits = 16;  ///< 8 and 16 are whole numbers without sign, 32 are floats
  bool big = false;

  std::uintmax_t bytes() const { return std::uintmax_t{1} * width * height * (bits / 8); }
};

double number_at(const unsigned char* at, const Layout& layout) {
  if (layout.bits == 8) return *at;
  if (layout.bits == 16) return layout.big ? at[0] << 8 | at[1] : at[1] << 8 | at[0];
  std::uint32_t word = 0;
  for (int i = 0; i < 4; ++i) word = word << 8 | at[layout.big ? i : 3 - i];
  return std::bit_cast<float>(word);
}

class RawSource final : public DemSource {
 public:
  RawSource(const std::filesystem::path& path, const Layout& layout)
      : layout_(layout), file_(path, std::ios::binary) {
    name = path.string();
    driver = fmt::format("Headerless {}-bit heightmap", layout.bits);
    stored_type = layout.bits == 8 ? GDT_Byte : layout.bits == 16 ? GDT_UInt16 : GDT_Float32;
    type = GDALGetDataTypeName(stored_type);
    bytes = layout.bits == 8;
    levels.push_back({layout.width, layout.height, 1});
  }

  /// Finds the order of bytes where nobody has said it; whether the heights are smooth in it.
  bool judge(ByteOrder said) {
    layout_.big = said == ByteOrder::big;
    double rough = roughness();
    if (said == ByteOrder::automatic && layout_.bits > 8) {
      layout_.big = true;
      const double big = roughness();
      layout_.big = big < rough * clearly_smoother;
      told_ = layout_.big || rough < big * clearly_smoother;
      rough = std::min(rough, big);
    }
    return smooth_ = rough < smooth_raw;
  }

  bool varies() { return roughness() > 0; }

  void tell(ByteOrder said) {
    std::string numbers = "bytes", how;
    if (layout_.bits > 8) {
      const char* order = layout_.big ? "big-endian" : "little-endian";
      numbers = fmt::format("{} {}", order, layout_.bits == 16 ? "16-bit heights" : "32-bit floats");
      if (said == ByteOrder::automatic)
        how = told_ ? " (that order is the smoother one)"
                    : " (nothing tells the order of its bytes; terrain.byte_order does)";
    }
    notes.push_back(
        fmt::format("has no header; taken as {} x {} {}{}.", layout_.width, layout_.height, numbers, how));
    if (!smooth_)
      notes.push_back(
          "its numbers jump about as no ground does; check terrain.raw_size and terrain.byte_order.");
  }

 private:
  /// The mean step between neighbours in a row, in parts of the mean distance of a value from their mean; the
  /// more where numbers are none that a heightmap holds. 0 where all are equal.
  double roughness() {
    std::vector<double> row(width());
    double steps = 0, off = 0;
    std::size_t good = 0, all = 0;
    for (const int r : spread_rows(height(), judged_rows)) {
      read_stored(0, 0, r, width(), 1, row.data());
      all += row.size();
      if (layout_.bits == 32)
        std::erase_if(row, [](double v) {
          return !std::isfinite(v) || std::abs(v) > largest_float || (v != 0 && std::abs(v) < least_float);
        });
      good += row.size();
      double sum = 0;
      for (const double v : row) sum += v;
      for (std::size_t i = 0; i < row.size(); ++i) {
        off += std::abs(row[i] - sum / static_cast<double>(row.size()));
        if (i > 0) steps += std::abs(row[i] - row[i - 1]);
      }
      row.resize(width());
    }
    if (good == 0) return std::numeric_limits<double>::infinity();
    return (off > 0 ? steps / off : 0) + 10 * static_cast<double>(all - good) / static_cast<double>(all);
  }

  void read_stored(std::size_t, int x, int y, int w, int h, double* out) override {
    const int size = layout_.bits / 8;
    std::vector<unsigned char> row(std::int64_t{w} * size);
    for (int r = 0; r < h; ++r) {
      file_.clear();
      file_.seekg((std::streamoff{y + r} * width() + x) * size);
      if (!file_.read(reinterpret_cast<char*>(row.data()), std::ssize(row)))
        fail(ErrorKind::input, "{} cannot be read whole; fetch it again.", name);
      for (int c = 0; c < w; ++c) *out++ = number_at(row.data() + std::ptrdiff_t{c} * size, layout_);
    }
  }

  Layout layout_;
  std::ifstream file_;
  bool told_ = true, smooth_ = true;
};

/// The bits a height that the end of a name speaks of; 0 where it does not say, nothing for other names.
std::optional<int> bits_named(const std::filesystem::path& path) {
  std::string end = path.extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  if (end == ".raw") return 0;
  if (end == ".r8") return 8;
  if (end == ".r16" || end == ".raw16") return 16;
  if (end == ".r32") return 32;
  return std::nullopt;
}

/// The layouts that fill a file of `size` bytes.
std::vector<Layout> layouts_of(std::uintmax_t size, const std::array<int, 2>& said, int bits_said) {
  std::vector<Layout> out;
  // Bytes come before floats: floats are rough as bytes, but bytes may be smooth as floats.
  for (const int bits : {16, 8, 32}) {
    if (bits_said != 0 && bits != bits_said) continue;
    const double side = std::round(std::sqrt(static_cast<double>(size) / (bits / 8)));
    if (side > most_raw_side) continue;
    Layout layout{.width = said[0], .height = said[1], .bits = bits};
    if (said[0] == 0) layout.width = layout.height = round_to(side);
    if (layout.width >= 2 && layout.height >= 2 && layout.bytes() == size) out.push_back(layout);
  }
  return out;
}

[[noreturn]] void fail_size(const std::filesystem::path& path, std::uintmax_t size, const DemOptions& options,
                            int bits) {
  const auto [w, h] = options.raw_size;
  const std::string of = bits == 0 ? "8, 16 or 32" : fmt::format("{}", bits);
  if (w > 0)
    fail(ErrorKind::input,
         "{} has {} bytes, which are not {} x {} heights of {} bits; check terrain.raw_size.", path.string(),
         size, w, h, of);
  fail(ErrorKind::input,
       "{} has {} bytes, which are no square of {}-bit heights; say how many columns and rows it has with "
       "terrain.raw_size, or convert it to PNG or TIFF.",
       path.string(), size, of);
}

/// Whether a name ends as those of another format do: such a file has lost what makes it one, its header or
/// the place that its name said.
bool named_otherwise(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 4> rows_with_header = {"flt", "bip", "bsq", "bil"};
  std::string end = path.extension().string();
  if (end.empty()) return false;
  end.erase(0, 1);
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  if (std::find(rows_with_header.begin(), rows_with_header.end(), end) != rows_with_header.end()) return true;
  ensure_gdal();
  GDALDriverManager& drivers = *GetGDALDriverManager();
  for (int i = 0; i < drivers.GetDriverCount(); ++i) {
    const char* const known = drivers.GetDriver(i)->GetMetadataItem(GDAL_DMD_EXTENSIONS);
    if (known != nullptr && fmt::format(" {} ", known).find(" " + end + " ") != std::string::npos)
      return true;
  }
  return false;
}

bool known_to_gdal(const std::filesystem::path& path) {
  GdalMessages messages;
  return GDALIdentifyDriver(path.c_str(), nullptr) != nullptr;
}

}  // namespace

std::unique_ptr<DemSource> open_raw(const std::filesystem::path& path, const DemOptions& options) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return nullptr;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size == 0) return nullptr;
  const bool said = options.raw_size[0] > 0;
  const std::optional<int> named = bits_named(path);
  const std::vector<Layout> fitting = layouts_of(size, options.raw_size, named.value_or(0));
  const bool told = said || named;
  if (!told && (fitting.empty() || named_otherwise(path))) return nullptr;
  // Such a file may belong to a header beside it.
  if (known_to_gdal(path)) return nullptr;
  if (fitting.empty()) fail_size(path, size, options, named.value_or(0));
  std::unique_ptr<RawSource> best;
  bool smooth = false;
  for (const Layout& layout : fitting) {
    auto source = std::make_unique<RawSource>(path, layout);
    const bool judged = source->judge(options.byte_order);
    if (best && (smooth || !judged)) continue;
    best = std::move(source);
    smooth = judged;
  }
  if (!told && !(smooth && best->varies())) return nullptr;
  best->tell(options.byte_order);
  return best;
}

}  // namespace tafoni::io::impl
