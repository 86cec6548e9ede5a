# OpenVDB::openvdb, where OpenVDB and what its headers use are installed. Debian's own module asks for more than
# this program needs. It is installed too, since whoever links the static libraries links OpenVDB.
find_path(OpenVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OpenVDB_LIBRARY openvdb)
find_package(Imath QUIET)
if(NOT TARGET TBB::tbb)
  find_package(TBB QUIET)
endif()
if(OpenVDB_INCLUDE_DIR)
  file(STRINGS ${OpenVDB_INCLUDE_DIR}/openvdb/version.h OpenVDB_VERSION REGEX "define OPENVDB_LIBRARY_VERSION_STRING ")
  string(REGEX REPLACE ".*\"([0-9.]+)\".*" "\\1" OpenVDB_VERSION "${OpenVDB_VERSION}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenVDB REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR Imath_FOUND TBB_FOUND
                                  VERSION_VAR OpenVDB_VERSION)
mark_as_advanced(OpenVDB_INCLUDE_DIR OpenVDB_LIBRARY)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED) # its headers are system headers and warn of nothing
  set_target_properties(OpenVDB::openvdb PROPERTIES IMPORTED_LOCATION ${OpenVDB_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${OpenVDB_INCLUDE_DIR}
                        INTERFACE_LINK_LIBRARIES "Imath::Imath;TBB::tbb")
endif()
