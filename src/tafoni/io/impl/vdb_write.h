#pragma once
// OpenVDB files out, by OpenVDB, whose headers take long to compile.

#include "tafoni/core/progress.h"
#include "tafoni/io/volume_file.h"

namespace tafoni {
class AtomicFile;
}

namespace tafoni::io::impl {

/// What stands in our files besides a volume's samples.
inline constexpr const char *vdb_size_key = "tafoni_size", *vdb_world_key = "world_origin",
                            *vdb_crs_key = "crs", *vdb_generator_key = "tafoni_generator";

/// One level set named surface. Throws Error{output}, also in a build without OpenVDB.
void write_vdb(AtomicFile& out, const Volume& volume, Progress& progress);

}  // namespace tafoni::io::impl
