#include "io/result_folder.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/scratch_folder.hpp"

namespace repose::io {
namespace {

namespace fs = std::filesystem;

class ResultFolderTest : public ::testing::Test {
 protected:
  const ScratchFolder scratch_;
  const fs::path base_ = scratch_.path();
};

using RowWriterTest = ResultFolderTest;
using FullDiskTest = ResultFolderTest;

void put(const fs::path& path) { std::ofstream(path) << path.filename().string(); }

std::string reason_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const IoError& error) {
    return error.reason();
  }
  return "no IoError";
}

TEST_F(ResultFolderTest, CreatesParentsAndWrites) {
  const ResultFolder folder(base_ / "a" / "b");
  folder.write_file("summary.json", "{}");
  EXPECT_EQ(content_of(base_ / "a" / "b" / "summary.json"), "{}");
  const ResultFolder again(base_ / "a" / "b");  // an existing folder is taken as it is
  EXPECT_EQ(content_of(again.file("summary.json")), "{}");
  EXPECT_EQ(ResultFolder::default_path("flat_mu_i"), fs::path("results/flat_mu_i"));
}

TEST_F(ResultFolderTest, RefusesAFileInItsPlace) {
  put(base_ / "file");
  EXPECT_EQ(reason_of([&] { ResultFolder(base_ / "file"); }),
            "cannot be a result folder: it is a file");
  EXPECT_EQ(reason_of([&] { ResultFolder(base_ / "file" / "below"); }),
            "cannot create the result folder: Not a directory");
  EXPECT_EQ(content_of(base_ / "file"), "file");
}

TEST_F(ResultFolderTest, IsWrittenIntoByOneProcessAlone) {
  const ResultFolder folder(base_ / "run");
  {
    const FolderClaim first(folder);
    try {
      const FolderClaim second(folder);
      FAIL() << "claimed twice";
    } catch (const IoError& error) {
      EXPECT_EQ(error.path(), folder.path());
      EXPECT_EQ(error.reason(), "process " + std::to_string(::getpid()) +
                                    " is writing into it; wait for its end, or give another "
                                    "folder with -o");
    }
  }
  EXPECT_FALSE(fs::exists(folder.file(".repose-lock")));
  const FolderClaim again(folder);
  // what a kill leaves holds nobody up
  std::ofstream(base_ / "left") << "";
  const ResultFolder other(base_ / "other");
  std::ofstream(other.file(".repose-lock")) << "12345\n";
  const FolderClaim of_other(other);
}

TEST_F(ResultFolderTest, ClearsItsOwnOlderOutputsOnly) {
  const ResultFolder folder(base_ / "run");
  fs::create_directory(folder.frames());
  const std::vector<fs::path> ours{folder.file("summary.json"),
                                   folder.file("series.csv"),
                                   folder.file("profile.csv"),
                                   folder.file("final.svg"),
                                   folder.checkpoint(),
                                   folder.file(".series.csv.repose-part"),
                                   folder.frames() / "heap_00012.hdf",
                                   folder.frames() / "heap.hdf.series",
                                   folder.frames() / "heap_123456.hdf",
                                   folder.frames() / ".heap_00013.hdf.repose-part"};
  const std::vector<fs::path> foreign{
      folder.file("input.toml"),      folder.file("notes.txt"),
      folder.file("series.csv.bak"),  folder.file("my_series.csv"),
      folder.frames() / "movie.pvsm", folder.frames() / "heap_12.hdf",
      folder.frames() / "other.hdf",  folder.frames() / "heap_0001x.hdf"};
  for (const auto& list : {ours, foreign})
    for (const fs::path& path : list) put(path);

  folder.remove_old_outputs();
  for (const fs::path& path : ours) EXPECT_FALSE(fs::exists(path)) << path;
  for (const fs::path& path : foreign) EXPECT_TRUE(fs::exists(path)) << path;
  EXPECT_TRUE(fs::exists(folder.frames()));
}

TEST_F(ResultFolderTest, AnEmptiedFramesFolderGoesToo) {
  const ResultFolder folder(base_);
  fs::create_directory(folder.frames());
  put(folder.frames() / "heap_00000.hdf");
  folder.remove_old_outputs();
  EXPECT_FALSE(fs::exists(folder.frames()));
  folder.remove_old_outputs();  // nothing there is no error
}

TEST_F(ResultFolderTest, LinksAreRemovedNotFollowed) {
  const ResultFolder folder(base_ / "run");
  fs::create_directory(base_ / "elsewhere");
  put(base_ / "elsewhere" / "heap_00000.hdf");
  put(base_ / "elsewhere" / "series.csv");
  fs::create_directory_symlink(base_ / "elsewhere", folder.frames());
  fs::create_symlink(base_ / "elsewhere" / "series.csv", folder.file("series.csv"));
  folder.remove_old_outputs();
  EXPECT_TRUE(fs::exists(base_ / "elsewhere" / "heap_00000.hdf"));
  EXPECT_TRUE(fs::exists(base_ / "elsewhere" / "series.csv"));
  EXPECT_FALSE(fs::exists(folder.file("series.csv")));
}

TEST_F(RowWriterTest, RowsAreOnDiskAtOnceAndReadBackExactly) {
  const fs::path path = base_ / "series.csv";
  RowWriter writer = RowWriter::create(path, {"time_s", "front_m", "step"});
  EXPECT_EQ(content_of(path), "time_s,front_m,step\n");
  writer.row(std::vector<double>{0.1, 1.0 / 3.0, 12345678});
  EXPECT_EQ(content_of(path), "time_s,front_m,step\n0.1,0.3333333333333333,12345678\n");
  EXPECT_EQ(std::stod("0.3333333333333333"), 1.0 / 3.0);
  writer.row(std::vector<double>{0.2, std::nan(""), -std::numeric_limits<double>::infinity()});
  EXPECT_TRUE(content_of(path).ends_with("\n0.2,nan,-inf\n"));
  EXPECT_THROW(writer.row(std::vector<double>{1.0}), std::invalid_argument);
  EXPECT_THROW(RowWriter::create(path, {}), std::invalid_argument);
  EXPECT_THROW(RowWriter::create(path, {"a,b"}), std::invalid_argument);
}

TEST_F(RowWriterTest, ContinuesAfterARestart) {
  const fs::path path = base_ / "series.csv";
  // The last line was cut short by the end of an older process.
  std::ofstream(path) << "time_s,x\n0,1\n0.1,2\n0.2,3\n0.3,4\n0.4,";
  {
    RowWriter writer = RowWriter::continued(path, {"time_s", "x"}, 0.2);
    writer.row(std::vector<double>{0.25, 9});
  }
  EXPECT_EQ(content_of(path), "time_s,x\n0,1\n0.1,2\n0.2,3\n0.25,9\n");
  std::ofstream(path, std::ios::app) << "0.4,";
  RowWriter::continued(path, {"time_s", "x"}, 1e9);
  EXPECT_EQ(content_of(path), "time_s,x\n0,1\n0.1,2\n0.2,3\n0.25,9\n");

  EXPECT_EQ(reason_of([&] {
              RowWriter::continued(path, {"time_s", "y"}, 1.0);
            }),
            "cannot be continued: its first line is 'time_s,x', expected 'time_s,y'");
  RowWriter::continued(base_ / "new.csv", {"time_s"}, 1.0);
  EXPECT_EQ(content_of(base_ / "new.csv"), "time_s\n");
  std::ofstream(base_ / "cut.csv") << "time_";
  RowWriter::continued(base_ / "cut.csv", {"time_s"}, 1.0);
  EXPECT_EQ(content_of(base_ / "cut.csv"), "time_s\n");
}

TEST_F(FullDiskTest, ADeviceWithoutSpaceSaysSo) {
  EXPECT_EQ(reason_of([] { RowWriter::create("/dev/full", {"time_s"}); }),
            "cannot write: No space left on device");
  EXPECT_EQ(reason_of([&] { RowWriter::create(base_ / "no" / "a.csv", {"x"}); }),
            "cannot open for writing: No such file or directory");
}

/// Fills a disk that takes fewer than `capacity` bytes and then answers with `reason`, first by
/// rows, then by a file; then makes space and goes on. Returns what went wrong, "" for nothing.
std::string fill_up(const fs::path& where, std::size_t capacity, const std::string& reason,
                    const std::function<void(const ResultFolder&)>& make_space) {
  const ResultFolder folder(where);
  folder.write_file("summary.json", "older");
  RowWriter writer = RowWriter::create(folder.file("series.csv"), {"time_s", "x"});
  std::size_t rows = 0;
  const auto one_row = [&] {
    writer.row(std::vector<double>{static_cast<double>(rows), 1.0 / 3.0});
    ++rows;
  };
  std::string refused = "no IoError";
  while (rows * 16 < capacity && refused == "no IoError") refused = reason_of(one_row);
  if (refused != reason) return "row: " + refused;
  const auto complete = [&] {
    const std::string table = content_of(writer.path());
    return table.ends_with(",0.3333333333333333\n") &&
           static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')) == rows + 1;
  };
  if (!complete()) return "the table does not hold the complete rows alone";

  refused = reason_of([&] { folder.write_file("summary.json", std::string(capacity, 'x')); });
  if (refused != reason) return "file: " + refused;
  if (content_of(folder.file("summary.json")) != "older") return "the older file is lost";
  if (std::distance(fs::directory_iterator(where), fs::directory_iterator()) != 2)
    return "a temporary stays behind";

  make_space(folder);
  refused = reason_of(one_row);
  if (refused != "no IoError") return "row with space again: " + refused;
  return complete() ? "" : "the table is broken after the row with space again";
}

TEST_F(FullDiskTest, WithALimitOnFileSizeOnlyCompleteRowsStay) {
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit limit{4099, before.rlim_max};  // not a multiple of a row, so the last one is cut
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string wrong =
      fill_up(base_ / "run", 20'000, "cannot write: File too large",
              [&](const ResultFolder&) { ::setrlimit(RLIMIT_FSIZE, &before); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(wrong, "");
}

TEST_F(FullDiskTest, OnAFullFileSystemOnlyCompleteRowsStay) {
  // A small file system of our own, seen by a child alone; no trace remains outside of it.
  constexpr int skipped = 77;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const bool own = ::unshare(CLONE_NEWNS) == 0 || ::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0;
    if (!own || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("tmpfs", base_.c_str(), "tmpfs", 0, "size=64k") != 0)
      ::_exit(skipped);
    std::string wrong;
    try {
      wrong = fill_up(base_ / "run", 200'000, "cannot write: No space left on device",
                      [](const ResultFolder& folder) { fs::remove(folder.file("summary.json")); });
    } catch (const std::exception& error) {
      wrong = error.what();
    }
    if (!wrong.empty()) std::fprintf(stderr, "%s\n", wrong.c_str());
    ::_exit(wrong.empty() ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == skipped) GTEST_SKIP() << "this system lets us mount nothing";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace repose::io
