// What a file may make GDAL read beyond itself, and what is no file at all. All inputs are harmless; what
// counts is that they are refused before GDAL gets them.

#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/stat.h>

#include "tafoni/io/inner/data_files.h"
#include "tafoni/io/network.h"
#include "tafoni/io/outside.h"
#include "tafoni/io/test/dem_inputs.h"
#include "tafoni/io/vector.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::Not;

class DemGuard : public testing::Test {
 protected:
  DemGuard() {
    fs::create_directories(inside / "tiles");
    write_tiff(inside / "tiles" / "own.tif", {.width = 8, .height = 8}, height);
    write_tiff(folder_.path / "other.tif", {.width = 8, .height = 8}, height);
  }
  fs::path put(const std::string& name, const std::string& text) const {
    std::ofstream(inside / name, std::ios::binary) << text;
    return inside / name;
  }
  /// A mosaic of one tile; `more` goes into its band, `head` before it.
  static std::string mosaic(const std::string& source, const std::string& more = "",
                            const std::string& head = "", const std::string& band = "") {
    return R"(<VRTDataset rasterXSize="8" rasterYSize="8"><GeoTransform>0,10,0,80,0,-10</GeoTransform>)" +
           head + R"(<VRTRasterBand dataType="Float32" band="1")" + band + ">" + more +
           "<SimpleSource><SourceFilename relativeToVRT=\"1\">" + source +
           "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>";
  }
  std::string refusal(const fs::path& path) const {
    const Thrown read = thrown_by([&] { read_dem(path); }), told = thrown_by([&] { inspect_dem(path); });
    EXPECT_EQ(read.kind, ErrorKind::input) << read.text;
    EXPECT_EQ(read.text, told.text);
    EXPECT_THAT(read.text, HasSubstr(path.filename().string()));
    return read.text;
  }

  const TestFolder folder_;
  const fs::path inside = folder_.path / "given";
};

TEST_F(DemGuard, MosaicsOfTilesBesideThemAreRead) {
  for (const std::string& source :
       {std::string("tiles/own.tif"), (inside / "tiles" / "own.tif").string(), std::string("a.vrt")}) {
    const Dem dem = read_dem(put(source == "a.vrt" ? "b.vrt" : "a.vrt", mosaic(source)));
    EXPECT_EQ(at(dem.raster, 3, 5), height(3, 5)) << source;
  }
}

TEST_F(DemGuard, OfWideMosaicsSomeRowsAreLookedAt) {
  // A terapixel, of which one tile of 64 pixels is there.
  std::string text = mosaic("tiles/own.tif", "<NoDataValue>-9</NoDataValue>");
  text.replace(0, text.find("><GeoTransform>"), R"(<VRTDataset rasterXSize="1000000" rasterYSize="1000000")");
  const std::string whole = R"(<SrcRect xOff="0" yOff="0" xSize="8" ySize="8"/><DstRect )";
  const auto placed = [&](const std::string& where) {
    std::string out = text;
    return out.insert(out.find("</SimpleSource>"), whole + where + "/>");
  };
  const DemInfo info = inspect_dem(put("wide.vrt", placed(R"(xOff="0" yOff="0" xSize="1000000" ySize="8")")));
  EXPECT_GT(info.highest, 300);
  EXPECT_GT(info.missing, 0.5);
  EXPECT_THAT(info.notes, testing::Contains(HasSubstr("rows, spread over the file")));
  const fs::path none = put("none.vrt", placed(R"(xOff="0" yOff="999992" xSize="1000000" ySize="8")"));
  EXPECT_THAT(thrown_by([&] { inspect_dem(none); }).text, HasSubstr("every pixel that was looked at"));
}

TEST_F(DemGuard, MosaicsKeepToTheirFolder) {
  for (const std::string& source :
       {std::string("../other.tif"), (folder_.path / "other.tif").string(),
        std::string("tiles/../../other.tif"), std::string("../missing.tif"), std::string("link.tif")}) {
    std::error_code code;
    fs::create_symlink(folder_.path / "other.tif", inside / "link.tif", code);
    EXPECT_THAT(refusal(put("out.vrt", mosaic(source))), HasSubstr("does not lie in its folder")) << source;
  }
  // Nor through another mosaic, an overview or a mask.
  put("first.vrt", mosaic("../other.tif"));
  EXPECT_THAT(refusal(put("second.vrt", mosaic("first.vrt"))), HasSubstr("does not lie in its folder"));
  const std::string other = "<SourceFilename>" + (folder_.path / "other.tif").string() + "</SourceFilename>";
  EXPECT_THAT(refusal(put("c.vrt", mosaic("tiles/own.tif", "<Overview>" + other + "</Overview>"))),
              HasSubstr("does not lie in its folder"));
  EXPECT_THAT(
      refusal(
          put("d.vrt", mosaic("tiles/own.tif", "",
                              "<MaskBand><VRTRasterBand dataType=\"Byte\"><SimpleSource>" + other +
                                  "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></MaskBand>"))),
      HasSubstr("does not lie in its folder"));
}

TEST_F(DemGuard, MosaicsOfTilesElsewhereAreReadWhereThatIsAllowed) {
  const fs::path far = put("far.vrt", mosaic((folder_.path / "other.tif").string()));
  EXPECT_THAT(refusal(far), HasSubstr("give --allow-outside"));
  allow_outside();
  EXPECT_EQ(at(read_dem(far).raster, 3, 5), height(3, 5));
  EXPECT_THAT(refusal(put("url.vrt", mosaic("http://127.0.0.1:9/a.tif"))), HasSubstr("--allow-network"));
  const fs::path endless = put("zero.vrt", mosaic("/dev/zero"));
  EXPECT_THAT(thrown_by([&] { read_dem(endless); }).text, HasSubstr("is a pipe or a device"));
  allow_outside(false);
  EXPECT_THAT(refusal(far), HasSubstr("does not lie in its folder"));
}

/// Makes an HDF5 file of one data set of 8 x 8 heights, "z"; `settings` are those of its creation.
void write_hdf5(const fs::path& path, hid_t settings = H5P_DEFAULT) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const std::array<hsize_t, 2> size{8, 8};
  const hid_t space = H5Screate_simple(2, size.data(), nullptr);
  const hid_t group = H5Gcreate2(file, "deeper", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t set = H5Dcreate2(file, "z", H5T_IEEE_F32LE, space, H5P_DEFAULT, settings, H5P_DEFAULT);
  ASSERT_GE(set, 0);
  std::array<float, 64> heights{};
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = 100 + static_cast<float>(i);
  if (settings == H5P_DEFAULT) H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, heights.data());
  H5Dclose(set);
  H5Gclose(group);
  H5Sclose(space);
  H5Fclose(file);
}

TEST_F(DemGuard, Hdf5TakesNothingFromOtherFiles) {
  const fs::path other = folder_.path / "other.h5", plain = inside / "plain.nc";
  write_hdf5(other);
  write_hdf5(plain);
  EXPECT_EQ(read_dem(plain).raster.width(), 8);

  const fs::path raw = inside / "raw.nc";
  const hid_t bytes = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(bytes, other.c_str(), 0, 256);
  write_hdf5(raw, bytes);
  H5Pclose(bytes);

  const fs::path pieces = inside / "pieces.nc";
  const hid_t mapped = H5Pcreate(H5P_DATASET_CREATE);
  const std::array<hsize_t, 2> size{8, 8};
  const hid_t space = H5Screate_simple(2, size.data(), nullptr);
  H5Pset_virtual(mapped, space, other.c_str(), "/z", space);
  write_hdf5(pieces, mapped);
  H5Sclose(space);
  H5Pclose(mapped);

  const fs::path linked = inside / "linked.nc";
  write_hdf5(linked);
  const hid_t file = H5Fopen(linked.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Lcreate_external(other.c_str(), "/z", file, "deeper/y", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);

  for (const fs::path& given : {raw, pieces, linked}) {
    EXPECT_THAT(refusal(given), HasSubstr("takes data from other files"));
    const std::string part = "NETCDF:\"" + given.string() + "\":z";
    EXPECT_THAT(thrown_by([&] { read_dem(part); }).text, HasSubstr("takes data from other files"));
    const fs::path vrt = put("of_it.vrt", mosaic(given.filename().string()));
    EXPECT_THAT(thrown_by([&] { read_dem(vrt); }).text, HasSubstr("takes data from other files"));
  }
  // Under another name, behind bytes of somebody else's, and as what is read along with another file.
  std::ifstream in(raw, std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(refusal(put("raw.tif", all)), HasSubstr("takes data from other files"));
  EXPECT_THAT(refusal(put("later.nc", std::string(1024, ' ') + all)),
              HasSubstr("takes data from other files"));
  EXPECT_THAT(refusal(put("cut.nc", all.substr(0, all.size() / 2))), HasSubstr("cannot be looked through"));
  put("tiles/own.tif.ovr", all);
  EXPECT_THAT(thrown_by([&] { read_dem(inside / "tiles" / "own.tif"); }).text,
              HasSubstr("takes data from other files"));
  // What is packed is not looked into, and so not read.
  const std::string packed = "/vsizip/" + (inside / "packed.zip").string() + "/raw.nc";
  VSILFILE* const out = VSIFOpenL(packed.c_str(), "wb");
  ASSERT_NE(out, nullptr);
  VSIFWriteL(all.data(), 1, all.size(), out);
  VSIFCloseL(out);
  for (const std::string& name : {packed, "NETCDF:\"" + packed + "\":z"})
    EXPECT_THAT(thrown_by([&] { read_dem(name); }).text, HasSubstr("unpack it")) << name;
  EXPECT_THAT(thrown_by([&] { read_dem(put("of_packed.vrt", mosaic(packed))); }).text,
              HasSubstr("unpack it"));
}

TEST_F(DemGuard, MosaicsAreNoMoreThanMosaics) {
  for (const std::string& text :
       {mosaic("tiles/own.tif", "", "", " subClass=\"VRTRawRasterBand\""),
        mosaic("tiles/own.tif", "<PixelFunctionType>real</PixelFunctionType>", "",
               " subClass=\"VRTDerivedRasterBand\""),
        mosaic("tiles/own.tif", "", "<GDALWarpOptions/>"),
        mosaic("tiles/own.tif", "",
               "<Metadata domain=\"OVERVIEWS\"><MDI key=\"OVERVIEW_FILE\">x</MDI></Metadata>")})
    EXPECT_THAT(refusal(put("more.vrt", text)), HasSubstr("more than a mosaic"));
  EXPECT_THAT(refusal(put("cut.vrt", mosaic("tiles/own.tif").substr(0, 200))), HasSubstr("cannot be read"));
}

TEST_F(DemGuard, WhatIsNoPathIsNoTile) {
  for (const char* source : {"MEM:::DATAPOINTER=0,PIXELS=2,LINES=2", "&lt;VRTDataset/&gt;", "NETCDF:a.nc:z",
                             "/vsistdin/", "PG:dbname=x"})
    EXPECT_THAT(refusal(put("odd.vrt", mosaic(source))), HasSubstr("odd.vrt names")) << source;
}

TEST_F(DemGuard, NothingIsFetchedUnasked) {
  for (const char* url :
       {"http://127.0.0.1:9/a.tif", "/vsicurl/http://127.0.0.1:9/a.tif", "/vsis3/bucket/a.tif",
        "http:/127.0.0.1:9/a.tif", "/vsizip//vsicurl/http://127.0.0.1:9/a.zip/a.tif"}) {
    EXPECT_THAT(thrown_by([&] { read_dem(url); }).text, HasSubstr("--allow-network")) << url;
    EXPECT_THAT(thrown_by([&] { read_polygons(url, ""); }).text, HasSubstr("--allow-network")) << url;
    EXPECT_THAT(refusal(put("web.vrt", mosaic(url))), HasSubstr("--allow-network")) << url;
  }
  // Nor for a coordinate system, which a stranger's file may name.
  DemOptions options;
  options.crs = "http://127.0.0.1:9/crs.wkt";
  EXPECT_THAT(thrown_by([&] { read_dem(inside / "tiles" / "own.tif", options); }).text,
              HasSubstr("not understood"));
  EXPECT_FALSE(network_allowed());
}

TEST_F(DemGuard, NamesThatGdalComposesAreNotOpened) {
  for (const char* name : {"MEM:::DATAPOINTER=0,PIXELS=2,LINES=2", "<VRTDataset/>", "WMS:x", "/vsistdin/",
                           "/vsisubfile/0_10,/etc/hostname", "PG:dbname=x", "NETCDF:none.nc:z"})
    EXPECT_THAT(thrown_by([&] { read_dem(name); }).kind, ErrorKind::input) << name;
  EXPECT_EQ(impl::memory_driver().GetDescription(), std::string("MEM"));
  EXPECT_EQ(GetGDALDriverManager()->GetDriverByName("MEM"), nullptr);
  EXPECT_EQ(GetGDALDriverManager()->GetDriverByName("WMS"), nullptr);
}

TEST_F(DemGuard, FilesThatAreNotWhatTheirNameSaysNameNoOthers) {
  EXPECT_THAT(refusal(put("dem.tif", mosaic("tiles/own.tif"))), HasSubstr("end its name in .vrt"));
  EXPECT_THAT(refusal(put("wms.tif",
                          "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://127.0.0.1:9/"
                          "${z}/${x}/${y}.png</ServerUrl></Service></GDAL_WMS>")),
              HasSubstr("none of the formats that are read"));
  const fs::path region = put("region.geojson", "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>" +
                                                    (inside / "b.geojson").string() +
                                                    "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
  EXPECT_THAT(thrown_by([&] { read_polygons(region, ""); }).text, HasSubstr("none of the formats"));
}

TEST_F(DemGuard, PipesAndDevicesAreRefusedAtOnce) {
  const fs::path pipe = inside / "pipe.tif";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(refusal(pipe), HasSubstr("is a pipe or a device"));
  EXPECT_THAT(refusal("/dev/zero"), HasSubstr("is a pipe or a device"));
  EXPECT_THAT(thrown_by([&] { read_polygons(pipe, ""); }).text, HasSubstr("is a pipe or a device"));
  // Beside a file, where GDAL would open it.
  ASSERT_EQ(::mkfifo((inside / "tiles" / "own.tif.aux.xml").c_str(), 0600), 0);
  EXPECT_THAT(refusal(inside / "tiles" / "own.tif"), HasSubstr("no such file as its name says"));
  const fs::path piped = put("piped.vrt", mosaic("tiles/own.tif"));
  EXPECT_THAT(thrown_by([&] { read_dem(piped); }).text, HasSubstr("no such file as its name says"));
}

TEST_F(DemGuard, SideFilesDoNotLeadElsewhere) {
  put("tiles/own.tif.aux.xml", "<PAMDataset><Metadata domain=\"OVERVIEWS\"><MDI key=\"OVERVIEW_FILE\">" +
                                   (folder_.path / "other.tif").string() + "</MDI></Metadata></PAMDataset>");
  EXPECT_THAT(refusal(inside / "tiles" / "own.tif"), HasSubstr("overviews in another file"));
  fs::remove(inside / "tiles" / "own.tif.aux.xml");
  put("tiles/own.tif.ovr", mosaic("../../other.tif"));
  EXPECT_THAT(refusal(inside / "tiles" / "own.tif"), HasSubstr("no such file as its name says"));
}

TEST_F(DemGuard, FoldersAreNotLookedInto) {
  EXPECT_THAT(refusal(inside), HasSubstr("is a folder"));
  EXPECT_THAT(data_files(inside / "none"), testing::IsEmpty());
  put("tiles/own.tfw", "1");
  put("tiles/own.tif.OVR", "1");
  put("tiles/other.tfw", "1");
  EXPECT_THAT(data_files(inside / "tiles" / "own.tif"),
              testing::UnorderedElementsAre(inside / "tiles" / "own.tif", inside / "tiles" / "own.tfw",
                                            inside / "tiles" / "own.tif.OVR"));
  EXPECT_THAT(data_files("/vsizip/" + (inside / "tiles" / "own.tif").string() + "/a.tif"),
              testing::Contains(inside / "tiles" / "own.tif"));
  EXPECT_THAT(data_files("NETCDF:\"" + (inside / "tiles" / "own.tif").string() + "\":z"),
              testing::Contains(inside / "tiles" / "own.tif"));
}

TEST_F(DemGuard, WhatIsBesideTheDataIsNamed) {
  // Raw pixels with their header: either name of the header leads to the data.
  std::string pixels(4 * 4 * 4, '\0');
  put("raw.img", pixels);
  const fs::path header = put("raw.hdr",
                              "ENVI\nsamples = 4\nlines = 4\nbands = 1\nheader offset = 0\nfile type = ENVI "
                              "Standard\ndata type = 4\ninterleave = bsq\nbyte order = 0\n");
  EXPECT_THAT(refusal(header), HasSubstr((inside / "raw.img").string()));
  // Points whose rows run to and fro: GDAL says where.
  std::string snake;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c)
      snake += fmt::format("{}.5 {}.5 {}.25\n", r % 2 == 0 ? 1000 + c : 1005 - c, 2000 - r, 50 + c);
  EXPECT_THAT(refusal(put("snake.xyz", snake)), HasSubstr("spacing"));
  EXPECT_THAT(refusal(put("alps.hgt", std::string(2 * 1201 * 1201, '\1'))), HasSubstr("N43E005.hgt"));
}

TEST_F(DemGuard, GroupsOfHdf5AreATree) {
  const fs::path nested = inside / "nested.nc", twice = inside / "twice.nc", deep = inside / "deep.nc";
  for (const auto& [path, levels] : {std::pair{nested, 20}, std::pair{twice, 1}, std::pair{deep, 120}}) {
    write_hdf5(path);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    std::string name;
    for (int i = 0; i < levels; ++i)
      H5Gclose(H5Gcreate2(file, (name += "/g").c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    if (path == twice) H5Lcreate_hard(file, "g", file, "deeper/again", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
  }
  EXPECT_EQ(read_dem(nested).raster.width(), 8);
  for (const fs::path& path : {twice, deep})
    EXPECT_THAT(refusal(path), HasSubstr("groups within groups without end, or one in two places"));
}

TEST_F(DemGuard, ArchivesAreEntered) {
  const std::string archive = (inside / "tile.zip").string();
  VSILFILE* const out = VSIFOpenL(("/vsizip/" + archive + "/data/readme.txt").c_str(), "wb");
  ASSERT_NE(out, nullptr);
  VSIFWriteL("words", 1, 5, out);
  VSIFCloseL(out);
  EXPECT_THAT(refusal(archive), HasSubstr("holds nothing that is read"));
  const std::string inner = "/vsizip/" + archive + "/data/dtm.asc";
  VSILFILE* const grid = VSIFOpenL(inner.c_str(), "wb");
  const std::string text = "ncols 3\nnrows 2\n" + at_home + "\n1 2 3\n4 5 6\n" + std::string(100, ' ');
  VSIFWriteL(text.data(), 1, text.size(), grid);
  VSIFCloseL(grid);
  EXPECT_THAT(refusal(archive), HasSubstr("name the file in it: " + inner));
  EXPECT_EQ(at(read_dem(inner).raster, 2, 1), 6);
  const std::string hidden = "/vsizip/" + archive + "/data/a.vrt";
  VSILFILE* const vrt = VSIFOpenL(hidden.c_str(), "wb");
  const std::string names = mosaic((folder_.path / "other.tif").string());
  VSIFWriteL(names.data(), 1, names.size(), vrt);
  VSIFCloseL(vrt);
  EXPECT_THAT(refusal(hidden), HasSubstr("a mosaic within an archive"));
  // Nor through a mosaic that may be read.
  EXPECT_THAT(refusal(put("of_packed.vrt", mosaic(hidden))), HasSubstr("a mosaic within an archive"));
}

}  // namespace
}  // namespace tafoni::io
