#include "io/atomic_file.hpp"

#include <csignal>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/scratch_folder.hpp"

namespace repose::io {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public ::testing::Test {
 protected:
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

/// No file of this process may grow beyond `bytes` while it is in scope: a write stops half-way
/// there with EFBIG, just as it stops with ENOSPC on a disk that fills up.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(AtomicFileTest, WritesAndReplaces) {
  const fs::path path = folder_ / "a.txt";
  const std::string bytes("one\0two\n", 8);
  write_atomically(path, bytes);
  EXPECT_EQ(content_of(path), bytes);
  write_atomically(path, "");
  EXPECT_EQ(content_of(path), "");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, AWriteCutShortKeepsTheOlderFile) {
  const fs::path path = folder_ / "a.txt";
  write_atomically(path, "older");
  {
    const FileSizeLimit limit(4096);
    try {
      write_atomically(path, std::string(10'000, 'x'));
      FAIL() << "no exception";
    } catch (const IoError& error) {
      EXPECT_EQ(error.path(), path);
      EXPECT_EQ(error.reason(), "cannot write: File too large");
      EXPECT_EQ(error.what(), path.string() + ": cannot write: File too large");
    }
  }
  EXPECT_EQ(content_of(path), "older");
  EXPECT_EQ(entries(), 1u);  // no temporary left
}

TEST_F(AtomicFileTest, AnOldTemporaryIsNoObstacle) {
  const fs::path path = folder_ / "a.txt";
  std::ofstream(temporary_name(path)) << std::string(100, 'y');  // of a process that was killed
  write_atomically(path, "new");
  EXPECT_EQ(content_of(path), "new");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, DoesNotFollowALinkPlantedUnderTheTemporaryName) {
  const fs::path path = folder_ / "a.txt";
  std::ofstream(folder_ / "foreign") << "foreign";
  fs::create_symlink(folder_ / "foreign", temporary_name(path));
  EXPECT_THROW(write_atomically(path, "new"), IoError);
  EXPECT_EQ(content_of(folder_ / "foreign"), "foreign");
}

TEST_F(AtomicFileTest, RefusesWhatIsNotAFile) {
  const auto reason = [](const fs::path& path) -> std::string {
    try {
      write_atomically(path, "x");
    } catch (const IoError& error) {
      return error.reason();
    }
    return "";
  };
  fs::create_directory(folder_ / "sub");
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(reason(folder_ / "sub"), "cannot write: it is a folder");
  EXPECT_EQ(reason(folder_ / "pipe"), "cannot write: it is a device or a pipe, not a file");
  EXPECT_EQ(reason(folder_ / "missing" / "a.txt"),
            "cannot create the file: No such file or directory");
  EXPECT_EQ(entries(), 2u);
}

}  // namespace
}  // namespace repose::io
