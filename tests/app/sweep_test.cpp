// [sweep]: many tests or runs in one process, against the same ones alone.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/command_line.hpp"
#include "input/read_sweep.hpp"
#include "io/fingerprint.hpp"
#include "io/json.hpp"
#include "tests/app/csv_table.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

const std::string test = R"([law]
name = "modified_cam_clay"
compression = "ln_v-ln_p"
M = 0.888
lambda = 0.161
kappa = 0.062
nu = 0.3
Gamma = 2.759
[initial]
p = 100e3
ocr = 1.0
[test]
kind = "triaxial"
drainage = "undrained"
axial_strain = 0.1
points = 20
)";

const std::string scene = R"([scene]
end_time = 0.02
gravity = 9.81
[domain]
size = [0.8, 0.4]
[[body]]
law = { name = "newtonian", eta = 1.0, K = 1e5, rho_0 = 1000.0 }
origin = [0.0, 0.0]
size = [0.2, 0.2]
[grid]
h = 0.05
)";

class Sweep : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string read(const std::string& name) const { return content_of(folder_ / name); }
  int run(const std::string& verb, const std::string& file, const std::string& out,
          std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"repose",  verb,       file, "-o", (folder_ / out).string(),
                                   "--quiet", "--no-plot"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return run_command_line(static_cast<int>(argv.size()), argv.data());
  }
  /// Everything that is wrong with a [sweep] of these lines.
  std::string problems(const std::string& lines) const {
    try {
      input::InputFile file = input::InputFile::parse(test + "[sweep]\n" + lines, "t.toml");
      input::read_sweep(file);
      file.throw_if_bad();
    } catch (const input::BadInput& error) {
      return error.what();
    }
    return "";
  }
  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST_F(Sweep, AGridHasEveryCombinationAsATestAloneHasIt) {
  const std::string file =
      write("g.toml",
            test + "[sweep]\ngrid = { \"initial.ocr\" = [1.0, 4.0], law.M = [0.8, 0.9, 1.0] }\n");
  ASSERT_EQ(run("point", file, "g"), 0);
  const Table rows = table_of(folder_ / "g/sweep.csv"), curves = table_of(folder_ / "g/curves.csv");
  ASSERT_EQ(rows.size(), 6u);
  const char* const ocr[] = {"1.0", "1.0", "1.0", "4.0", "4.0", "4.0"};
  const char* const M[] = {"0.8", "0.9", "1.0", "0.8", "0.9", "1.0"};
  for (std::size_t k = 0; k < 6; ++k) {
    Table::value_type row = rows[k];
    EXPECT_EQ(row["run"], std::to_string(k + 1));
    EXPECT_EQ(row["initial.ocr"], ocr[k]);
    EXPECT_EQ(row["law.M"], M[k]);
    EXPECT_EQ(row["status"], "done");
    const std::string alone = "alone" + std::to_string(k);
    ASSERT_EQ(run("point", write("t.toml", test), alone,
                  {"--set", fmt::format("initial.ocr={}", ocr[k]), "--set",
                   fmt::format("law.M={}", M[k])}),
              0);
    Table curve = table_of(folder_ / alone / "curve.csv");
    EXPECT_EQ(row["end_q_Pa"], curve.back()["q_Pa"]);
    const auto summary = io::Json::parse(read(alone + "/summary.json"));
    EXPECT_EQ(row["S_u_Pa"], fmt::format("{}", summary["laboratory"]["S_u_Pa"].get<double>()));
    ASSERT_EQ(curve.size(), 21u);
    for (std::size_t i = 0; i < curve.size(); ++i) {
      Table::value_type of_sweep = curves[21 * k + i];
      for (const auto& [name, cell] : curve[i]) EXPECT_EQ(of_sweep[name], cell) << name;
    }
  }
  EXPECT_EQ(curves.size(), 6u * 21u);
}

TEST_F(Sweep, AListAndATableSayTheSame) {
  write("sets.csv", "initial.ocr,law.M\n1.0,0.8\n,0.9\n8.0,1.0\n");
  ASSERT_EQ(run("point", write("t.toml", test + "[sweep]\ntable = \"sets.csv\"\n"), "table"), 0);
  ASSERT_EQ(
      run("point",
          write("l.toml", test + "[sweep]\nlist = [{ \"initial.ocr\" = 1.0, \"law.M\" = 0.8 }, "
                                 "{ law = { M = 0.9 } }, "
                                 "{ \"law.M\" = 1.0, \"initial.ocr\" = 8.0 }]\n"),
          "list"),
      0);
  EXPECT_EQ(read("table/curves.csv"), read("list/curves.csv"));
  EXPECT_EQ(read("table/sweep.csv"), read("list/sweep.csv"));
  // the input that it leaves makes it again, from anywhere
  ASSERT_EQ(run("point", (folder_ / "table/input.toml").string(), "again"), 0);
  EXPECT_EQ(read("table/curves.csv"), read("again/curves.csv"));
}

TEST_F(Sweep, TheThreadsDoNotMatterAndNeitherDoesAnInterruption) {
  std::string ocr;
  for (int i = 0; i < 150; ++i) ocr += fmt::format("{}{:.2f}", i == 0 ? "" : ", ", 1.0 + 0.05 * i);
  const std::string file =
      write("t.toml", test + "[sweep]\ngrid = { \"initial.ocr\" = [" + ocr + "] }\n");
  ASSERT_EQ(run("point", file, "one", {"--threads", "1"}), 0);
  ASSERT_EQ(run("point", file, "four", {"--threads", "4"}), 0);
  EXPECT_EQ(read("one/curves.csv"), read("four/curves.csv"));
  EXPECT_EQ(read("one/sweep.csv"), read("four/sweep.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "one/finished.jsonl"));

  // what a kill leaves: whole lines of the log, a line cut short, rows of curves beyond them
  const std::string curves = read("one/curves.csv");
  const auto line = [&](int run) {
    const std::size_t begin = curves.find(fmt::format("\n{},", run)) + 1;
    const std::size_t end = curves.find(fmt::format("\n{},", run + 1)) + 1;
    return fmt::format(
        R"({{"run":{},"status":"done","reason":"kept","rows":21,"wall_s":0.0,"figures":{{}},)"
        R"("checksum":"{}"}})"
        "\n",
        run, io::fingerprint_of(curves.substr(begin, end - begin)));
  };
  fs::create_directory(folder_ / "cut");
  fs::copy(folder_ / "one/input.toml", folder_ / "cut/input.toml");
  write("cut/curves.csv", curves.substr(0, curves.size() / 2));
  write("cut/finished.jsonl", line(1) + line(2) + line(3).substr(0, 20));
  ASSERT_EQ(run("point", file, "cut", {"--resume"}), 0);
  EXPECT_EQ(read("cut/curves.csv"), curves);
  Table kept = table_of(folder_ / "cut/sweep.csv"), whole = table_of(folder_ / "one/sweep.csv");
  ASSERT_EQ(kept.size(), 150u);
  EXPECT_EQ(kept[1]["reason"], "kept");
  EXPECT_EQ(kept[2], whole[2]);
  EXPECT_EQ(kept[149], whole[149]);
  EXPECT_EQ(io::Json::parse(read("cut/summary.json"))["runs_kept"], 2);
  // rows that are not those that the log tells of are driven again
  fs::create_directory(folder_ / "changed");
  fs::copy(folder_ / "one/input.toml", folder_ / "changed/input.toml");
  std::string changed = curves;
  changed[changed.find("\n2,") + 4] ^= 1;
  write("changed/curves.csv", changed);
  write("changed/finished.jsonl", line(1) + line(2) + line(3));
  ASSERT_EQ(run("point", file, "changed", {"--resume"}), 0);
  EXPECT_EQ(read("changed/curves.csv"), curves);
  EXPECT_EQ(io::Json::parse(read("changed/summary.json"))["runs_kept"], 1);
  // finished: nothing is done again
  const auto written = fs::last_write_time(folder_ / "cut/curves.csv");
  ASSERT_EQ(run("point", file, "cut", {"--resume"}), 0);
  EXPECT_EQ(fs::last_write_time(folder_ / "cut/curves.csv"), written);
  // another input: nothing of it is kept
  ASSERT_EQ(run("point", file, "cut", {"--resume", "--set", "law.M=0.9"}), 0);
  EXPECT_EQ(io::Json::parse(read("cut/summary.json"))["runs_kept"], 0);
}

TEST_F(Sweep, WhatCannotBeUsedIsARowAndWhatFailsToo) {
  const std::string file = write(
      "t.toml",
      test + "[sweep]\ngrid = { \"law.kappa\" = [0.05, 0.2], \"test.axial_strain\" = [0.1] }\n");
  ASSERT_EQ(run("point", file, "a"), 0);
  Table rows = table_of(folder_ / "a/sweep.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["status"], "done");
  EXPECT_EQ(rows[1]["status"], "refused");
  EXPECT_NE(rows[1]["reason"].find("kappa must be < lambda"), std::string::npos)
      << rows[1]["reason"];
  EXPECT_EQ(table_of(folder_ / "a/curves.csv").size(), 21u);
  // all refused: bad input, nothing written
  testing::internal::CaptureStderr();
  EXPECT_EQ(
      run("point", write("u.toml", test + "[sweep]\ngrid = { \"law.lamda\" = [0.1, 0.2] }\n"), "b"),
      2);
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_NE(told.find("lambda"), std::string::npos) << told;
  EXPECT_FALSE(fs::exists(folder_ / "b/sweep.csv"));
  // a path that breaks off
  std::string dry = test;
  dry.replace(dry.find("undrained"), 9, "drained");
  dry.replace(dry.find("axial_strain = 0.1"), 18, "q_end = 400e3\ncontrol = \"stress\"");
  ASSERT_EQ(run("point",
                write("v.toml", dry + "[sweep]\ngrid = { \"test.q_end\" = [50e3, 400e3] }\n"), "c"),
            0);
  Table ends = table_of(folder_ / "c/sweep.csv");
  EXPECT_EQ(ends[0]["status"], "done");
  EXPECT_EQ(ends[1]["status"], "failed");
}

// A table as a spreadsheet writes it, and the sweep.csv that it leaves read back.
TEST_F(Sweep, ATableOfParametersMayHaveTheSpellingsOfMeasuredOnes) {
  write("sets.csv", "initial.ocr;law.M;test.drainage\n1,5;+,9;undrained\n2;.95;drained\n");
  ASSERT_EQ(run("point", write("t.toml", test + "[sweep]\ntable = \"sets.csv\"\n"), "a"), 2)
      << "+,9 is no number";
  write("sets.csv", "initial.ocr;law.M;test.drainage\n1,5;+0,9;undrained\n2;,95;drained\n");
  ASSERT_EQ(run("point", write("t.toml", test + "[sweep]\ntable = \"sets.csv\"\n"), "a"), 0);
  Table rows = table_of(folder_ / "a/sweep.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["initial.ocr"], "1.5");
  EXPECT_EQ(rows[0]["status"], "done");
  EXPECT_EQ(rows[1]["law.M"], "0.95");
  EXPECT_EQ(rows[1]["test.drainage"], "drained");
  write("twice.csv", "law.M,law.M\n0.9,1.0\n");
  EXPECT_EQ(run("point", write("u.toml", test + "[sweep]\ntable = \"twice.csv\"\n"), "b"), 2);
}

TEST_F(Sweep, ItsMistakes) {
  const auto says = [&](const std::string& lines, const std::string& part) {
    const std::string text = problems(lines);
    EXPECT_NE(text.find(part), std::string::npos) << lines << ": " << text;
    EXPECT_NE(text.find("t.toml:"), std::string::npos) << text;
  };
  says("", "needs one of grid, list and table, and has none");
  says("grid = { a = [1] }\nlist = [{ a = 1 }]\n", "has several");
  says("grid = { \"initial.ocr\" = 4.0 }\n", "needs a list of at least one value");
  says("grid = { \"initial.ocr\" = [] }\n", "needs a list of at least one value");
  says("grid = {}\n", "must be a table of lists");
  says("list = [{ a = 1 }, {}]\n", "with at least one key each");
  says("list = []\n", "must be a list of 1 to");
  says("list = [1, 2]\n", "must be a list of 1 to");
  says("grid = { \"sweep.table\" = [1] }\n", "a sweep cannot change [sweep] itself");
  says("table = \"no_such_file.csv\"\n", "no_such_file.csv");
  says("gird = { a = [1] }\n", "grid");
  std::string many;
  for (int i = 0; i < 200; ++i) many += fmt::format("{}{}", i == 0 ? "" : ",", i);
  says(fmt::format("grid = {{ a = [{0}], b = [{0}] }}\n", many), "more than 20000 runs");
  // --resume and --threads are of sweeps
  EXPECT_EQ(run("point", write("t.toml", test), "a", {"--resume"}), 2);
}

TEST_F(Sweep, RunsOfAScene) {
  const std::string file =
      write("s.toml", scene + "[sweep]\ngrid = { \"body[0].law.eta\" = [1.0, 100.0] }\n");
  ASSERT_EQ(run("run", file, "a", {"--threads", "1"}), 0);
  Table rows = table_of(folder_ / "a/sweep.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1]["body[0].law.eta"], "100.0");
  ASSERT_EQ(run("run", write("t.toml", scene), "alone",
                {"--threads", "1", "--set", "body[0].law.eta=100.0"}),
            0);
  EXPECT_EQ(read("alone/series.csv"), read("a/runs/0002/series.csv"));
  EXPECT_EQ(
      rows[1]["front_m"],
      fmt::format("{}", io::Json::parse(read("alone/summary.json"))["front_m"].get<double>()));
  // one run is missing: it alone is done again
  fs::remove_all(folder_ / "a/runs/0002");
  fs::remove(folder_ / "a/summary.json");
  const auto written = fs::last_write_time(folder_ / "a/runs/0001/series.csv");
  ASSERT_EQ(run("run", file, "a", {"--threads", "1", "--resume"}), 0);
  EXPECT_EQ(fs::last_write_time(folder_ / "a/runs/0001/series.csv"), written);
  EXPECT_EQ(read("alone/series.csv"), read("a/runs/0002/series.csv"));
}

// A run that is refused keeps its number: those behind it lie in the folders of theirs.
TEST_F(Sweep, ARefusedRunOfASceneKeepsItsNumber) {
  const std::string file =
      write("s.toml",
            scene +
                "[sweep]\nlist = [{ \"body[0].law.eta\" = 1.0 }, { \"body[3].law.eta\" = 1.0 }, "
                "{ \"body[0].law.eta\" = 100.0 }]\n");
  ASSERT_EQ(run("run", file, "a", {"--threads", "1"}), 0);
  Table rows = table_of(folder_ / "a/sweep.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1]["status"], "refused");
  EXPECT_NE(rows[1]["reason"].find("there is only body[0]"), std::string::npos);
  EXPECT_EQ(rows[2]["status"], "done");
  EXPECT_TRUE(fs::exists(folder_ / "a/runs/0003/series.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "a/runs/0002"));
}

}  // namespace
}  // namespace repose::app
