// An HDF5 file, as netCDF and BAG may be, can have links to objects of other files, take samples from raw
// bytes of any file, or put a data set together from others. Its library follows all of these unasked, so
// each object is looked at before GDAL is given the file.

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <set>
#include <string_view>
#include <vector>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#define H5_USE_110_API  // objects have addresses; those of later versions have tokens
#include <hdf5.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/gdal_names.h"

namespace tafoni::io::impl {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature("\x89HDF\r\n\x1a\n", 8);
/// The signature stands at the start, or at this place, or where twice, four times … as much came before.
constexpr vsi_l_offset first_user_block = 512;
/// GDAL 3.6.2 takes a file for HDF5's netCDF by these endings alone, with the signature at any such place for
/// the first three, and at the first two for the others.
constexpr const char* sought_in[] = {"nc", "nc4", "cdf", "nc3", "grd"};

/// No model of terrain comes near to these; libraries that go through groups by recursion end at some depth.
constexpr int deepest_group = 100;
constexpr std::size_t most_objects = 1000000;

/// HDF5's library prints what fails, unless it is told otherwise, for each thread.
class SilentHdf5 {
 public:
  SilentHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~SilentHdf5() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  SilentHdf5(const SilentHdf5&) = delete;
  SilentHdf5& operator=(const SilentHdf5&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// A number that stands for an open object of HDF5; below 0: for none.
template <herr_t (*Close)(hid_t)>
struct Hdf5Handle {
  explicit Hdf5Handle(hid_t held) : id(held) {}
  ~Hdf5Handle() {
    if (id >= 0) Close(id);
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  const hid_t id;
};

enum Visit : herr_t { unreadable = -1, next = 0, elsewhere = 1, entangled = 2, crowded = 3 };

/// Goes through a file group by group. H5Lvisit() does so by recursion, as deep as a file may want.
class Hdf5Walk {
 public:
  Visit walk(hid_t file) {
    H5O_info_t root;
    if (H5Oget_info2(file, &root, H5O_INFO_BASIC) < 0) return unreadable;
    seen_.insert(root.addr);
    groups_.push_back({root.addr, 0});
    while (!groups_.empty()) {
      const Group group = groups_.back();
      groups_.pop_back();
      const Hdf5Handle<H5Oclose> open(H5Oopen_by_addr(file, group.at));
      if (open.id < 0) return unreadable;
      depth_ = group.depth;
      const herr_t found = H5Literate(open.id, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, &visit, this);
      if (found < 0) return unreadable;
      if (found > 0) return static_cast<Visit>(found);
    }
    return next;
  }

 private:
  struct Group {
    haddr_t at;
    int depth;
  };

  static herr_t visit(hid_t group, const char* name, const H5L_info_t* link, void* self) {
    return static_cast<Hdf5Walk*>(self)->link(group, name, *link);
  }

  Visit link(hid_t group, const char* name, const H5L_info_t& link) {
    if (link.type >= H5L_TYPE_UD_MIN) return elsewhere;
    if (link.type != H5L_TYPE_HARD) return next;  // by name to another link of this file
    const Hdf5Handle<H5Oclose> object(H5Oopen(group, name, H5P_DEFAULT));
    H5O_info_t info;
    if (object.id < 0 || H5Oget_info2(object.id, &info, H5O_INFO_BASIC) < 0) return unreadable;
    const bool is_new = seen_.insert(info.addr).second;
    if (seen_.size() > most_objects) return crowded;
    if (info.type == H5O_TYPE_GROUP) {
      if (!is_new || depth_ == deepest_group) return entangled;
      groups_.push_back({info.addr, depth_ + 1});
    }
    if (info.type != H5O_TYPE_DATASET || !is_new) return next;
    const Hdf5Handle<H5Pclose> made(H5Dget_create_plist(object.id));
    if (made.id < 0) return unreadable;
    return H5Pget_layout(made.id) == H5D_VIRTUAL || H5Pget_external_count(made.id) != 0 ? elsewhere : next;
  }

  std::set<haddr_t> seen_;
  std::vector<Group> groups_;  ///< to be gone through
  int depth_ = 0;              ///< of the group that is gone through
};

}  // namespace

bool holds_hdf5(const std::string& name) {
  const std::unique_ptr<VSILFILE, int (*)(VSILFILE*)> file(VSIFOpenL(name.c_str(), "rb"), VSIFCloseL);
  if (!file) return false;
  // Elsewhere than on a disk, each step costs what lies between: a request, or all of it unpacked.
  const auto ends_in = [&](const char* ending) { return EQUAL(CPLGetExtension(name.c_str()), ending); };
  const bool sought =
      !name.starts_with("/vsi") || std::any_of(std::begin(sought_in), std::end(sought_in), ends_in);
  std::array<char, hdf5_signature.size()> read{};
  for (vsi_l_offset at = 0;; at = at == 0 ? first_user_block : 2 * at) {
    if (VSIFSeekL(file.get(), at, SEEK_SET) != 0 ||
        VSIFReadL(read.data(), 1, read.size(), file.get()) != read.size())
      return false;
    if (std::string_view(read.data(), read.size()) == hdf5_signature) return true;
    if (!sought) return false;
  }
}

void check_hdf5(const fs::path& path) {
  if (!holds_hdf5(path.string())) return;
  const SilentHdf5 silent;
  const Hdf5Handle<H5Fclose> file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Visit found = file.id < 0 ? unreadable : Hdf5Walk().walk(file.id);
  if (found == elsewhere)
    fail(ErrorKind::input,
         "{} takes data from other files, which are not read; make one file of it, as gdal_translate does.",
         path.string());
  if (found == entangled)
    fail(ErrorKind::input, "{} has groups within groups without end, or one in two places; write it anew.",
         path.string());
  if (found == crowded)
    fail(ErrorKind::input,
         "{} holds more than {} objects; write the one that is wanted into a file of its own.", path.string(),
         most_objects);
  if (found == unreadable)
    fail(ErrorKind::input,
         "{} is an HDF5 file that cannot be looked through: it is damaged, newer than this program's "
         "library, or "
         "being written.",
         path.string());
}

}  // namespace tafoni::io::impl
