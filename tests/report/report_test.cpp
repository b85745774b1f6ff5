// The parts of `repose report`: tables, packed frames, escaping, and what is refused.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "input/input_file.hpp"
#include "io/base64.hpp"
#include "io/csv_columns.hpp"
#include "io/frame_writer.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "io/thin_evenly.hpp"
#include "report/page/pack_frames.hpp"
#include "report/page/page.hpp"
#include "report/page/read_result.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::report {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(ThinEvenly, KeepsBothEnds) {
  EXPECT_EQ(io::thin_evenly(3, 10), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(io::thin_evenly(11, 3), (std::vector<std::size_t>{0, 5, 10}));
  EXPECT_EQ(io::thin_evenly(5, 1), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(io::thin_evenly(0, 5).empty());
  const std::vector<std::size_t> many = io::thin_evenly(8192, 5000);
  EXPECT_EQ(many.size(), 5000u);
  EXPECT_EQ(many.back(), 8191u);
  EXPECT_TRUE(std::adjacent_find(many.begin(), many.end(), std::greater_equal<>()) == many.end());
}

std::string base64_of(std::string_view text) {
  return io::base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Base64, VectorsOfRfc4648) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xff\xef\xfe"), "/+/+");
}

TEST(CsvColumns, NumbersWordsAndWhatIsNotFinite) {
  const Json table = io::csv_columns(
      "time_s,method,x\n0,\"a, \"\"b\"\"\",1.23456789e-5\n0.5,ida,nan\n1,ida,\n2,ida,-inf\n", "t");
  EXPECT_EQ(table["rows"], 4);
  EXPECT_EQ(table["columns"][0],
            Json::parse(R"({"name": "time_s", "values": [0.0, 0.5, 1.0, 2.0]})"));
  EXPECT_EQ(table["columns"][1]["words"], Json::parse(R"(["a, \"b\"", "ida"])"));
  EXPECT_EQ(table["columns"][1]["of"], Json::parse("[0, 1, 1, 1]"));
  EXPECT_EQ(table["columns"][2]["values"], Json::parse(R"([1.234568e-5, "nan", null, "-inf"])"));
}

TEST(CsvColumns, ARowOfAnotherLengthIsRefusedUnlessAKillCutItOff) {
  EXPECT_EQ(io::csv_columns("a,b\n1,2\n3", "t")["rows"], 1);
  try {
    io::csv_columns("a,b\n1,2\n3\n4,5\n", "runs/series.csv");
    FAIL();
  } catch (const io::IoError& error) {
    EXPECT_STREQ(error.what(), "runs/series.csv:3: has 1 values, and the header names 2 columns");
  }
}

TEST(CsvColumns, LongTablesAreThinned) {
  std::string csv = "i\n";
  for (int i = 0; i <= 100; ++i) csv += fmt::format("{}\n", i);
  const Json table = io::csv_columns(csv, "t", 5);
  EXPECT_EQ(table["rows"], 101);
  EXPECT_EQ(table["columns"][0]["values"], Json::parse("[0.0, 25.0, 50.0, 75.0, 100.0]"));
}

std::vector<std::uint8_t> decoded(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(c));
    held += 6;
    if (held >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (held -= 8) & 255));
  }
  return bytes;
}

io::Frame frame_of(double time, std::vector<double> x, std::vector<double> p) {
  io::Frame frame;
  frame.time_s = time;
  frame.points = x.size();
  for (const double value : x)
    frame.position_m.insert(frame.position_m.end(), {value, 2 * value, 0});
  frame.fields.push_back({"pressure_Pa", 1, std::move(p)});
  return frame;
}

TEST(PackFrames, PlacesAndValuesComeBackWithinHalfAStep) {
  const std::vector<io::Frame> frames{frame_of(0.0, {0.0, 0.31, 1.2}, {0.0, 37.0, 254.5}),
                                      frame_of(0.5, {0.1, 0.7}, {100.25, 0.5})};
  const Json packed = pack_frames(2, [&](std::size_t i) { return frames[i]; });
  EXPECT_EQ(packed["times"], Json::parse("[0.0, 0.5]"));
  EXPECT_EQ(packed["counts"], Json::parse("[3, 2]"));
  EXPECT_EQ(packed["lost"], 0);
  EXPECT_EQ(packed["depth"], false);
  const std::vector<std::uint8_t> xy = decoded(packed["xy"].get<std::string>());
  ASSERT_EQ(xy.size(), 20u);
  const Json& field = packed["fields"][0];
  const std::vector<std::uint8_t> codes = decoded(field["codes"].get<std::string>());
  ASSERT_EQ(codes.size(), 5u);
  std::size_t at = 0;
  for (const io::Frame& frame : frames)
    for (std::size_t i = 0; i < frame.points; ++i, ++at) {
      const double x = packed["x"][0].get<double>() +
                       (packed["x"][1].get<double>() - packed["x"][0].get<double>()) / 65534.0 *
                           (xy[4 * at] + 256 * xy[4 * at + 1]);
      // half a step of the code, and the rounding of the place to float, 2⁻²⁴ of at most 1.2
      EXPECT_NEAR(x, frame.position_m[3 * i], 0.5 * 1.2 / 65534.0 + 1.2 * 6e-8);
      const double lower = field["lower"].get<double>(), upper = field["upper"].get<double>();
      const double p = lower + (upper - lower) / 254.0 * codes[at];
      // values beyond the colours stand at their ends
      const double wanted = std::clamp(frame.fields[0].values[i], lower, upper);
      EXPECT_NEAR(p, wanted, 0.5 * (upper - lower) / 254.0 + 254.5 * 6e-8);
    }
  EXPECT_EQ(field["least"], 0.0);
  EXPECT_EQ(field["largest"], 254.5);
}

TEST(PackFrames, WhatIsNoNumberIsCountedAndMarked) {
  const Json packed = pack_frames(1, [](std::size_t) {
    return frame_of(0.0, {0.0, nan, 1.0}, {1.0, 2.0, nan});
  });
  EXPECT_EQ(packed["lost"], 3);  // x and y of one point, the pressure of another
  const std::vector<std::uint8_t> xy = decoded(packed["xy"].get<std::string>());
  EXPECT_EQ(xy[4] + 256 * xy[5], 65535);
  EXPECT_EQ(decoded(packed["fields"][0]["codes"].get<std::string>())[2], 255);
}

TEST(PackFrames, AFewExtremePointsDoNotBleachTheColours) {
  std::vector<double> x(1000), p(1000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<double>(i);
    p[i] = 0.5 + x[i];
  }
  p[17] = 1e9;
  const Json packed = pack_frames(1, [&](std::size_t) { return frame_of(0.0, x, p); });
  EXPECT_LT(packed["fields"][0]["upper"].get<double>(), 1000.0);
  EXPECT_EQ(packed["fields"][0]["largest"], 1e9);
  EXPECT_EQ(packed["fields"][0]["lower"], 0.0);  // near enough for the scale to begin there
}

TEST(PackFrames, LimitsThinFramesAndPointsAndSaySo) {
  const auto next = [](std::size_t i) {
    return frame_of(static_cast<double>(i), std::vector<double>(100, 1.0 + static_cast<double>(i)),
                    std::vector<double>(100, static_cast<double>(i)));
  };
  const Json packed = pack_frames(50, next, {.frames = 5, .points = 40, .points_in_all = 150});
  EXPECT_EQ(packed["times"].size(), 5u);
  EXPECT_EQ(packed["times"][4], 49.0);
  EXPECT_EQ(packed["counts"], Json::parse("[30, 30, 30, 30, 30]"));
  EXPECT_EQ(packed["all_frames"], 50);
  EXPECT_EQ(packed["most_points"], 100);
}

TEST(PackFrames, AVectorIsItsMagnitudeAndTheThirdDimensionIsTold) {
  const Json packed = pack_frames(1, [](std::size_t) {
    io::Frame frame;
    frame.points = 2;
    frame.position_m = {0, 0, 0, 1, 1, 5};
    frame.fields = {{"velocity_m_per_s", 3, {3, 4, 0, 0, 0, 2}},
                    {"stress_Pa", 6, std::vector<double>(12, 1.0)},
                    {"constant", 1, {7, 7}}};
    return frame;
  });
  EXPECT_EQ(packed["depth"], true);
  ASSERT_EQ(packed["fields"].size(), 1u);
  EXPECT_EQ(packed["fields"][0]["name"], "velocity_m_per_s");
  EXPECT_EQ(packed["fields"][0]["least"], 2.0);
  EXPECT_EQ(packed["fields"][0]["largest"], 5.0);
}

// Over a terrain: z is south, the page's y north of the map's lower edge.
TEST(PackFrames, FromAboveTheSouthIsBelow) {
  const Json packed = pack_frames(
      1,
      [](std::size_t) {
        io::Frame frame;
        frame.points = 2;
        frame.position_m = {0, 7, 10, 1, 8, 30};
        return frame;
      },
      {}, 100.0);
  EXPECT_EQ(packed["depth"], false);
  EXPECT_EQ(packed["y"], Json::parse("[70, 90]"));
  const std::vector<std::uint8_t> xy = decoded(packed["xy"].get<std::string>());
  EXPECT_EQ(xy[2] + 256 * xy[3], 65534);
}

TEST(ReportPage, NothingInAResultIsMarkup) {
  EXPECT_EQ(html_text("<a b=\"c\" d='e'>&"), "&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt;&amp;");
  const Json hostile{{"label", "</script><script>alert(1)</script>"},
                     {"input", "<!-- <script> \xff /*script*/ <!--data-->"}};
  EXPECT_EQ(script_json(hostile).find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(script_json(hostile))["label"], hostile["label"]);
  // a byte that is no UTF-8 becomes the replacement character
  EXPECT_NE(script_json(hostile).find("\xef\xbf\xbd"), std::string::npos);

  const std::string page = report_page(std::vector{hostile}, "</title><b>/*style*/&");
  const auto count = [&](std::string_view what) {
    std::size_t n = 0;
    for (std::size_t at = page.find(what); at != page.npos; at = page.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("</script>"), 2u);  // the data's and the program's
  EXPECT_EQ(count("</title>"), 1u);
  EXPECT_NE(page.find("&lt;/title&gt;&lt;b&gt;/*style*/&amp;"), page.npos);
  for (const char* const link : {"src=\"http", "href=\"http", "src=\"//", "@import", "url(http"})
    EXPECT_EQ(count(link), 0u) << link;
}

class ReadResultTest : public ::testing::Test {
 protected:
  void write(const fs::path& name, std::string_view text) const {
    fs::create_directories((base_ / name).parent_path());
    std::ofstream(base_ / name) << text;
  }
  template <typename Error>
  std::string refusal(const fs::path& folder) const {
    try {
      read_result(folder);
    } catch (const Error& error) {
      return error.what();
    }
    return "not refused";
  }
  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
};

TEST_F(ReadResultTest, TakesWhatAFolderHolds) {
  write("a/summary.json", R"({"kind": "stability", "status": "done"})");
  write("a/map.csv", "x,y\n1,2\n");
  write("a/map.svg", "<svg/>");
  write("a/input.toml", "[stability]\n");
  write("a/.hidden.csv", "ragged\n1,2\n");
  const Json result = read_result(base_ / "a/");
  EXPECT_EQ(result["label"], "a");
  EXPECT_EQ(result["kind"], "stability");
  EXPECT_EQ(result["tables"].size(), 1u);
  EXPECT_EQ(result["pictures"][0]["svg"], "<svg/>");
  EXPECT_EQ(result["input"], "[stability]\n");
  EXPECT_FALSE(result.contains("frames"));
  write("b/summary.json", R"({"status": "done"})");
  EXPECT_EQ(read_result(base_ / "b")["kind"], "run");
}

TEST_F(ReadResultTest, ReadsFrames) {
  write("a/summary.json", "{}");
  io::FrameView view;
  const std::vector<double> x{0.0, 1.0}, p{3.0, 4.0};
  view.x_m = x;
  view.y_m = x;
  view.scalars = {{"pressure_Pa", p}};
  const fs::path frame = io::FrameWriter(base_ / "a/frames", "sand").write(view);
  EXPECT_EQ(read_result(base_ / "a")["frames"]["counts"], Json::parse("[2]"));
  std::ofstream(frame) << "broken";
  EXPECT_EQ(refusal<io::IoError>(base_ / "a").find(frame.string() + ": is cut short"), 0u);
  fs::remove(frame);
  EXPECT_EQ(refusal<io::IoError>(base_ / "a").find(frame.string() + ": cannot read"), 0u);
}

TEST_F(ReadResultTest, SaysWhatIsWrong) {
  EXPECT_EQ(refusal<io::IoError>(base_ / "none"),
            (base_ / "none").string() + ": there is no such folder");
  write("results/one/summary.json", "{");
  const std::string results = (base_ / "results").string();
  EXPECT_EQ(refusal<input::BadInput>(base_ / "results"),
            results + ": is not a result folder: it has no summary.json; one below it is: try " +
                results + "/one");
  write("results/two/summary.json", "{}");
  EXPECT_EQ(refusal<input::BadInput>(base_ / "results"),
            results + ": is not a result folder: it has no summary.json; those below it are: try " +
                results + "/*");
  EXPECT_EQ(refusal<io::IoError>(base_ / "results/one"),
            results + "/one/summary.json: is not a JSON object");
}

}  // namespace
}  // namespace repose::report
