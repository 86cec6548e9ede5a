// An HDF5 file, as netCDF and BAG may be, can have links to objects of other files, take samples from raw
// bytes of any file, or put a data set together from others. Its library follows all of these unasked, so
// each object is looked at before GDAL is given the file.

#include <array>
#include <memory>
#include <string_view>

#include <cpl_vsi.h>
#include <hdf5.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/gdal_names.h"

namespace tafoni::io::impl {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature("\x89HDF\r\n\x1a\n", 8);
/// The signature stands at the start, or at this place, or where twice, four times … as much came before.
constexpr vsi_l_offset first_user_block = 512;

/// Its library prints what fails, unless it is told otherwise, for each thread.
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

/// What is held by a number that is below 0 when there is none.
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

enum Visit : herr_t { damaged = -1, next = 0, elsewhere = 1 };

herr_t visit_link(hid_t group, const char* name, const H5L_info_t* link, void*) {
  if (link->type >= H5L_TYPE_UD_MIN) return elsewhere;
  if (link->type != H5L_TYPE_HARD) return next;  // by name to another link of this file
  const Hdf5Handle<H5Oclose> object(H5Oopen(group, name, H5P_DEFAULT));
  if (object.id < 0) return damaged;
  if (H5Iget_type(object.id) != H5I_DATASET) return next;
  const Hdf5Handle<H5Pclose> made(H5Dget_create_plist(object.id));
  if (made.id < 0) return damaged;
  return H5Pget_layout(made.id) == H5D_VIRTUAL || H5Pget_external_count(made.id) != 0 ? elsewhere : next;
}

}  // namespace

bool holds_hdf5(const std::string& name) {
  const std::unique_ptr<VSILFILE, int (*)(VSILFILE*)> file(VSIFOpenL(name.c_str(), "rb"), VSIFCloseL);
  if (!file) return false;
  std::array<char, hdf5_signature.size()> read{};
  for (vsi_l_offset at = 0;; at = at == 0 ? first_user_block : 2 * at) {
    if (VSIFSeekL(file.get(), at, SEEK_SET) != 0 ||
        VSIFReadL(read.data(), 1, read.size(), file.get()) != read.size())
      return false;
    if (std::string_view(read.data(), read.size()) == hdf5_signature) return true;
  }
}

void check_hdf5(const fs::path& path) {
  if (!holds_hdf5(path.string())) return;
  const SilentHdf5 silent;
  const Hdf5Handle<H5Fclose> file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const herr_t found =
      file.id < 0 ? herr_t{damaged} : H5Lvisit(file.id, H5_INDEX_NAME, H5_ITER_NATIVE, visit_link, nullptr);
  if (found == elsewhere)
    fail(ErrorKind::input,
         "{} takes data from other files, which are not read; make one file of it, as gdal_translate does.",
         path.string());
  if (found < 0) fail(ErrorKind::input, "{} is a damaged HDF5 file; write it again.", path.string());
}

}  // namespace tafoni::io::impl
