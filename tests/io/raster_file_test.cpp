/// Maps in files of several kinds, and the coordinate systems that they say they are in.

#include "io/raster_file.hpp"

#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "io/atomic_file.hpp"
#include "io/coordinate_system.hpp"
#include "io/table_error.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::io {
namespace {

namespace fs = std::filesystem;

// UTM 32 North, shortened; in WKT 2, and in WKT 1 as GDAL 2 and ESRI wrote it
const std::string utm_2 =
    R"(PROJCRS["WGS 84 / UTM zone 32N",BASEGEOGCRS["WGS 84",DATUM["World Geodetic System 1984",)"
    R"(ELLIPSOID["WGS 84",6378137,298.257223563,LENGTHUNIT["metre",1]]],ID["EPSG",4326]],)"
    R"(CONVERSION["UTM zone 32N",METHOD["Transverse Mercator",ID["EPSG",9807]]],CS[Cartesian,2],)"
    R"(AXIS["E",east,ORDER[1],LENGTHUNIT["metre",1]],AXIS["N",north,ORDER[2],)"
    R"(LENGTHUNIT["metre",1,ID["EPSG",9001]]],ID["EPSG",32632]])";
const std::string utm_1 =
    R"(PROJCS["UTM 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.25]],)"
    R"(UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]],)"
    R"(PROJECTION["Transverse_Mercator"],UNIT["metre",1,AUTHORITY["EPSG","9001"]],)"
    R"(AXIS["Easting",EAST]%)";

std::string utm_1_with(const std::string& end) {
  std::string text = utm_1;
  return text.replace(text.find('%'), 1, end);
}

TEST(CoordinateSystemTest, TellsMetresFromOtherUnits) {
  EXPECT_EQ(why_not_metres(utm_2), "");
  EXPECT_EQ(why_not_metres(utm_1_with("]")), "");
  EXPECT_EQ(why_not_metres(""), "");
  EXPECT_EQ(why_not_metres("Projection    UTM\nZone 32\n"), "") << "what ArcInfo wrote tells less";
  EXPECT_EQ(why_not_metres(R"(GEOGCS["WGS 84",DATUM["WGS_1984"],UNIT["degree",0.01745]])"),
            "its places are in degrees (WGS 84)");
  EXPECT_EQ(why_not_metres(R"( GEOGCRS [ "a ""b""", CS[ellipsoidal,2] ])"),
            "its places are in degrees (a \"b\")");
  EXPECT_EQ(
      why_not_metres(
          R"(PROJCS["Ohio",GEOGCS["x",UNIT["degree",0.0174]],UNIT["US survey foot",0.304800609601219]])"),
      "its places are in US survey foot, 0.304800609601219 m");
  EXPECT_EQ(why_not_metres(R"(PROJCRS["p",AXIS["x",east,LENGTHUNIT["foot",0.3048]]])"),
            "its places are in foot, 0.3048 m");
  const auto with_heights = [](const std::string& unit) {
    return "COMPD_CS[\"both\"," + utm_1_with(",AUTHORITY[\"EPSG\",\"32632\"]]") +
           ",VERT_CS[\"h\",VERT_DATUM[\"d\",2005],UNIT[" + unit +
           "],AUTHORITY[\"EPSG\",\"5703\"]]]";
  };
  EXPECT_EQ(why_not_metres(with_heights("\"metre\",1")), "");
  EXPECT_EQ(why_not_metres(with_heights("\"foot\",0.3048")), "its heights are in foot, 0.3048 m");
  EXPECT_EQ(epsg_of(with_heights("\"metre\",1")), "32632") << "not the number of the heights";
  // broken or endless
  for (const std::string& text :
       {std::string("GEOGCS["), std::string("GEOGCS[\"WGS 84"), std::string(100'000, '['),
        std::string("A[") + std::string(1000, 'B'), [] {
          std::string deep;
          for (int k = 0; k < 100'000; ++k) deep += "A[";
          return deep;
        }()})
    EXPECT_EQ(why_not_metres(text), "");
}

TEST(CoordinateSystemTest, TheNumberIsTheSystemsOwn) {
  EXPECT_EQ(epsg_of(utm_2), "32632");
  EXPECT_EQ(epsg_of(utm_1_with(",AUTHORITY[\"EPSG\",\"32632\"]]")), "32632");
  EXPECT_EQ(epsg_of(utm_1_with("]")), "") << "9001 is that of the metre, 4326 of the ellipsoid";
  EXPECT_EQ(epsg_of(utm_1_with(",AUTHORITY[\"ESRI\",\"102\"]]")), "");
  EXPECT_EQ(epsg_of(""), "");
}

class RasterFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path() / "small.asc") << small;
    if (gdal_library().empty())
      GTEST_SKIP() << "built without GDAL: scripts/packages maps installs it";
  }
  /// A map of GDAL's own kind in text, whose values are those of small.asc.
  fs::path vrt(const std::string& transform, const std::string& system = "EPSG:32632",
               const std::string& band = "", int bands = 1) const {
    const fs::path file = folder_.path() / "map.vrt";
    std::ofstream out(file);
    out << "<VRTDataset rasterXSize=\"3\" rasterYSize=\"2\">";
    if (!system.empty()) out << "<SRS>" << system << "</SRS>";
    if (!transform.empty()) out << "<GeoTransform>" << transform << "</GeoTransform>";
    for (int k = 1; k <= bands; ++k)
      out << "<VRTRasterBand dataType=\"Float64\" band=\"" << k
          << "\"><NoDataValue>-9999</NoDataValue>" << band
          << "<SimpleSource><SourceFilename relativeToVRT=\"1\">small.asc</SourceFilename>"
             "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>";
    out << "</VRTDataset>";
    return file;
  }
  static std::string complaint(const fs::path& file) {
    try {
      read_raster(file);
    } catch (const TableError& error) {
      return error.cause() + "; " + error.cure();
    }
    return "";
  }

  static constexpr const char* small =
      "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -9999\n"
      "1 2 3\n4.5 -9999 6e1\n";
  static constexpr const char* place = "100, 10, 0, 220, 0, -10";
  ScratchFolder folder_;
};

TEST_F(RasterFileTest, ReadsTheSameThroughBothDoors) {
  const RasterFile text = read_raster(folder_.path() / "small.asc");
  EXPECT_FALSE(text.through_gdal);
  const RasterFile other = read_raster(vrt(place));
  EXPECT_TRUE(other.through_gdal);
  EXPECT_EQ(epsg_of(other.crs), "32632");
  EXPECT_EQ(why_not_metres(other.crs), "");
  EXPECT_EQ(other.raster.columns, 3U);
  EXPECT_EQ(other.raster.rows, 2U);
  EXPECT_EQ(other.raster.west, text.raster.west);
  EXPECT_EQ(other.raster.south, text.raster.south);
  EXPECT_EQ(other.raster.cell, text.raster.cell);
  for (std::size_t k = 0; k < 6; ++k) {
    if (k == 4)
      EXPECT_TRUE(std::isnan(other.raster.values[k]));
    else
      EXPECT_EQ(other.raster.values[k], text.raster.values[k]);
  }
  // numbers that the file keeps as whole ones, with their scale
  const RasterFile scaled =
      read_raster(vrt(place, "EPSG:32632", "<Offset>100</Offset><Scale>0.5</Scale>"));
  EXPECT_EQ(scaled.raster.values[3], 102.25);
  EXPECT_NE(scaled.content, other.content) << "the fingerprint is that of the numbers";
}

TEST_F(RasterFileTest, AGeoTiffComesBackAsItWasWritten) {
  Raster map = read_raster(folder_.path() / "small.asc").raster;
  map.west = 640123.25;
  map.values[0] = 1.23456;
  const std::string bytes = geotiff_of(map, 3, read_raster(vrt(place)).crs);
  EXPECT_EQ(geotiff_of(map, 3, read_raster(vrt(place)).crs), bytes) << "the same bytes";
  std::ofstream(folder_.path() / "map.bin", std::ios::binary) << bytes;
  const RasterFile again = read_raster(folder_.path() / "map.bin");  // by what it is, not its name
  EXPECT_TRUE(again.through_gdal);
  EXPECT_EQ(epsg_of(again.crs), "32632");
  EXPECT_EQ(again.raster.west, 640123.25);
  EXPECT_EQ(again.raster.south, 200.0);
  EXPECT_EQ(again.raster.values[0], static_cast<double>(1.235f));
  EXPECT_EQ(again.raster.values[5], 60.0);
  EXPECT_TRUE(std::isnan(again.raster.values[4]));
}

TEST_F(RasterFileTest, SaysWhatIsWrong) {
  EXPECT_EQ(
      complaint(vrt("100, 10, 1, 220, 0, -10")),
      "it is rotated or sheared; gdalwarp -tr CELL CELL writes it north-up with square cells");
  EXPECT_EQ(complaint(vrt("100, 10, 0, 200, 0, 10")),
            "it is not north-up; gdalwarp -tr CELL CELL writes it north-up with square cells");
  EXPECT_EQ(complaint(vrt("100, 10, 0, 220, 0, -12")),
            "its cells are 10 m wide and 12 m high, not square; gdalwarp -tr CELL CELL writes it "
            "north-up with square cells");
  // off by a thousandth of a cell in all: round-off of a program before
  EXPECT_EQ(complaint(vrt("100, 10, 0, 220, 0, -10.003")), "");
  EXPECT_EQ(complaint(vrt("")), "it does not tell where it lies; gdal_translate -a_ullr says so");
  EXPECT_EQ(complaint(vrt(place, "EPSG:32632", "", 3)),
            "it has 3 bands, and one is needed; gdal_translate -b 1 takes the first");
  EXPECT_EQ(complaint(vrt(place, "EPSG:32632", "<UnitType>ft</UnitType>")),
            "its numbers are in ft, not in metres; gdal_calc.py makes metres of them");
  EXPECT_EQ(complaint(vrt(place, "EPSG:32632", "<UnitType>metre</UnitType>")), "");
  EXPECT_EQ(why_not_metres(read_raster(vrt(place, "EPSG:4326")).crs),
            "its places are in degrees (WGS 84)");
  EXPECT_EQ(read_raster(vrt(place, "")).crs, "") << "where none is said none is known";
  std::ofstream(folder_.path() / "huge.vrt")
      << "<VRTDataset rasterXSize=\"20000\" rasterYSize=\"10000\"><GeoTransform>" << place
      << "</GeoTransform><VRTRasterBand dataType=\"Byte\" band=\"1\"/></VRTDataset>";
  EXPECT_EQ(complaint(folder_.path() / "huge.vrt"),
            "200000000 cells are more than memory is likely to hold (100000000); cut out what the "
            "scene needs: gdal_translate -projwin");
  std::ofstream(folder_.path() / "broken.tif") << "II*" << '\0' << "nothing follows";
  EXPECT_NE(complaint(folder_.path() / "broken.tif").find("nor a raster that GDAL opens: "),
            std::string::npos);
  std::ofstream(folder_.path() / "letter.txt") << "Dear all,\n";
  EXPECT_NE(complaint(folder_.path() / "letter.txt").find("neither an ESRI ASCII grid nor"),
            std::string::npos);
  EXPECT_THROW(read_raster(folder_.path() / "nothing.tif"), IoError);
  // an ESRI ASCII grid with a fault is told as one
  std::ofstream(folder_.path() / "comma.asc")
      << "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 1,5\n";
  EXPECT_NE(complaint(folder_.path() / "comma.asc").find("decimal points"), std::string::npos);
}

// Without GDAL the message names what makes an ESRI ASCII grid of it; with it, what GDAL says.
TEST(BrokenRasterTest, IsNeverTakenForAnEsriGrid) {
  const ScratchFolder folder;
  std::ofstream(folder.path() / "map.tif") << "II*";
  try {
    read_raster(folder.path() / "map.tif");
    ADD_FAILURE() << "a TIFF was taken for an ESRI ASCII grid";
  } catch (const std::exception& error) {
    const std::string told = error.what();
    EXPECT_NE(told.find("map.tif"), std::string::npos) << told;
    EXPECT_NE(told.find(gdal_library().empty() ? "gdal_translate -of AAIGrid" : "GDAL"),
              std::string::npos)
        << told;
  }
}

}  // namespace
}  // namespace repose::io
