// A VRT is a text that names other files, pieces of which GDAL puts together. Its driver can do far more:
// read raw bytes of any file, run code, ask servers. Only a mosaic passes here, of files beside it unless
// others are allowed.

#include <algorithm>
#include <set>
#include <string_view>

#include <cpl_minixml.h>
#include <cpl_vsi.h>

#include "tafoni/core/error.h"
#include "tafoni/core/input_file.h"
#include "tafoni/io/impl/gdal.h"
#include "tafoni/io/impl/gdal_names.h"
#include "tafoni/io/network.h"
#include "tafoni/io/outside.h"

namespace tafoni::io::impl {
namespace {

namespace fs = std::filesystem;

/// A tile takes some 700 bytes: a mosaic of a hundred thousand.
constexpr std::uint64_t largest_vrt = std::uint64_t{64} << 20;
/// Where GDAL looks for a VRT's first element.
constexpr std::size_t looked_at = 1024;

/// What a mosaic is made of.
constexpr std::string_view plain_elements[] = {"VRTDataset",
                                               "SRS",
                                               "GeoTransform",
                                               "GCPList",
                                               "GCP",
                                               "VRTRasterBand",
                                               "NoDataValue",
                                               "ColorInterp",
                                               "Description",
                                               "UnitType",
                                               "Offset",
                                               "Scale",
                                               "BlockXSize",
                                               "BlockYSize",
                                               "Overview",
                                               "OverviewList",
                                               "MaskBand",
                                               "SimpleSource",
                                               "SourceBand",
                                               "SrcRect",
                                               "DstRect",
                                               "ComplexSource",
                                               "NODATA",
                                               "AveragedSource",
                                               "Kernel",
                                               "Size",
                                               "Coefs",
                                               "UseMaskBand",
                                               "ScaleOffset",
                                               "ScaleRatio",
                                               "LUT",
                                               "SourceFilename",
                                               "SourceProperties",
                                               "KernelFilteredSource",
                                               "HideNoDataValue"};
/// Words about the data that no file is opened for; what they hold is not looked into.
constexpr std::string_view remark_elements[] = {"Metadata", "CategoryNames", "Histograms", "ColorTable",
                                                "GDALRasterAttributeTable"};
constexpr const char* plain_class = "VRTSourcedRasterBand";
/// A source within a mask's band within the mask within the data set, and room.
constexpr int deepest = 16;

bool is_one_of(std::string_view word, const auto& words) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

struct DestroyXml {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};

class VrtCheck {
 public:
  explicit VrtCheck(const fs::path& owner) : owner_(owner) {}

  /// Names in a VRT that is a link are relative to what it points at.
  void check(const fs::path& vrt) {
    std::error_code code;
    const fs::path real = fs::canonical(vrt, code);
    if (code || !seen_.insert(real).second) return;
    if (vrt.extension() != ".vrt" && vrt.extension() != ".VRT")
      fail(ErrorKind::input,
           "{} is not what its name says but a VRT, a text that names other files; if that is meant, end its "
           "name in .vrt.",
           vrt.string());
    const InputFile file(vrt);
    if (file.size() > largest_vrt)
      fail(ErrorKind::input, "{} is a VRT of {} MB; at most {} MB are read.", vrt.string(), file.size() >> 20,
           largest_vrt >> 20);
    GdalMessages messages;
    const std::unique_ptr<CPLXMLNode, DestroyXml> root(CPLParseXMLString(file.whole().c_str()));
    if (!root) fail(ErrorKind::input, "{} is a VRT that cannot be read{}.", vrt.string(), messages.because());
    for (const CPLXMLNode* node = root.get(); node != nullptr; node = node->psNext)
      if (node->eType == CXT_Element && node->pszValue[0] != '?') element(*node, real, 0);
  }

 private:
  void element(const CPLXMLNode& node, const fs::path& vrt, int depth) {
    const std::string_view name = node.pszValue;
    if (is_one_of(name, remark_elements)) return check_remark(node);
    if (!is_one_of(name, plain_elements)) refuse(name);
    const std::string_view kind = CPLGetXMLValue(&node, "subClass", plain_class);
    if (kind != plain_class) refuse(kind);
    if (depth > deepest) refuse("too many levels");
    for (const CPLXMLNode* child = node.psChild; child != nullptr; child = child->psNext)
      if (child->eType == CXT_Element) element(*child, vrt, depth + 1);
    if (name == "SourceFilename") source(node, vrt);
  }

  [[noreturn]] void refuse(std::string_view what) const {
    fail(ErrorKind::input,
         "{} holds more than a mosaic of files ({}), which is not read; make a GeoTIFF of it, as "
         "gdal_translate does.",
         owner_.string(), what.substr(0, 40));
  }

  /// GDAL takes overviews from where this item of the metadata says.
  void check_remark(const CPLXMLNode& node) const {
    if (std::string_view(CPLGetXMLValue(&node, "domain", "")) == "OVERVIEWS") refuse("overviews elsewhere");
  }

  void source(const CPLXMLNode& node, const fs::path& vrt) {
    const std::string name = CPLGetXMLValue(&node, nullptr, "");
    const bool relative = std::string_view(CPLGetXMLValue(&node, "relativeToVRT", "0")) == "1";
    if (on_network(name)) {
      if (network_allowed()) return check_piece(name);
      fail(ErrorKind::input, "{} names {}, which is not on this machine; fetch it, or give --allow-network.",
           owner_.string(), name);
    }
    std::error_code code;
    fs::path file = relative ? vrt.parent_path() / name : fs::path(name);
    if (!fs::exists(file, code)) {
      if (name.find_first_of(":<") == std::string::npos && !name.starts_with("/vsi"))
        return check_place(file);  // a tile that is not there, which may never be asked for
      const auto inside = name.starts_with("/vsi") ? file_in_name(name) : std::nullopt;
      if (!inside)
        fail(ErrorKind::input, "{} names {}, which is no file; check it.", owner_.string(),
             name.substr(0, 200));
      file = *inside;
    }
    check_place(file);
    check_piece(name.starts_with("/vsi") ? fs::path(name) : file);
  }

  /// What is no mosaic names no other file. A mosaic that is packed or far away is not looked into.
  void check_piece(const fs::path& piece) {
    const std::string name = checked_name(piece, "a piece of a mosaic");
    if (!looks_like_vrt(name)) return;
    std::error_code code;
    if (fs::exists(piece, code)) return check(piece);
    fail(ErrorKind::input,
         "{} names {}, a mosaic within an archive or on the network; fetch or unpack it, and name that.",
         owner_.string(), name);
  }

  void check_place(const fs::path& file) const {
    if (!outside_allowed())
      check_inside(file, owner_,
                   "if both are yours, give --allow-outside, else copy that file into its folder");
  }

  const fs::path& owner_;
  std::set<fs::path> seen_;
};

}  // namespace

bool looks_like_vrt(const std::string& name) {
  VSILFILE* const file = VSIFOpenL(name.c_str(), "rb");
  if (file == nullptr) return false;
  std::string text(looked_at, '\0');
  text.resize(VSIFReadL(text.data(), 1, text.size(), file));
  VSIFCloseL(file);
  constexpr std::string_view first = "<vrtdataset";
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  return std::search(text.begin(), text.end(), first.begin(), first.end(), same) != text.end();
}

void check_vrt(const fs::path& path) {
  VrtCheck(path).check(path);
}

}  // namespace tafoni::io::impl
