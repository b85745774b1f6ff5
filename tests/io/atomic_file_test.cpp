#include "io/atomic_file.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
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

TEST_F(AtomicFileTest, OldTemporariesAreNoObstacleAndAreRemovedWhereTheirProcessIsGone) {
  const fs::path path = folder_ / "a.txt";
  const pid_t gone = [] {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);
    return child;
  }();
  const fs::path of_the_gone = folder_ / (".a.txt." + std::to_string(gone) + "-0.repose-part");
  const fs::path of_the_living =
      folder_ / (".a.txt." + std::to_string(::getpid()) + "-999.repose-part");
  const fs::path of_an_older_version = folder_ / ".a.txt.repose-part";
  const fs::path of_another_file = folder_ / (".b.txt." + std::to_string(gone) + "-0.repose-part");
  for (const fs::path& part : {of_the_gone, of_the_living, of_an_older_version, of_another_file})
    std::ofstream(part) << std::string(100, 'y');
  write_atomically(path, "new");
  EXPECT_EQ(content_of(path), "new");
  remove_old_parts(folder_, [](std::string_view name) { return name == "a.txt"; });
  EXPECT_FALSE(fs::exists(of_the_gone));
  EXPECT_FALSE(fs::exists(of_an_older_version));
  EXPECT_TRUE(fs::exists(of_the_living));
  EXPECT_TRUE(fs::exists(of_another_file));
  EXPECT_EQ(name_of_part(of_the_gone.filename().string()), "a.txt");
  EXPECT_EQ(name_of_part(".a.b-c.repose-part"), "a.b-c");
  EXPECT_FALSE(name_of_part("a.txt"));
}

// 400 writes by four threads and 100 each by two processes, to one name: none fails, and what is
// there is always one of them, whole.
TEST_F(AtomicFileTest, ManyWritersAtOnce) {
  const fs::path path = folder_ / "a.txt";
  const auto text = [](int writer) { return std::string(20'000, static_cast<char>('a' + writer)); };
  write_atomically(path, text(0));
  const auto write = [&](int writer) {
    for (int k = 0; k < 100; ++k) write_atomically(path, text(writer), Outlives::kill);
  };
  std::array<pid_t, 2> children{};
  for (std::size_t c = 0; c < children.size(); ++c) {
    children[c] = ::fork();
    if (children[c] != 0) continue;
    try {
      write(10 + static_cast<int>(c));
    } catch (...) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  std::atomic<int> failures{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      try {
        write(t);
      } catch (const IoError&) {
        ++failures;
      }
    });
  for (int k = 0; k < 200; ++k) {
    const std::string seen = content_of(path);
    ASSERT_EQ(seen.size(), 20'000u);
    ASSERT_EQ(seen.find_first_not_of(seen.front()), std::string::npos);
  }
  for (std::thread& thread : threads) thread.join();
  for (const pid_t child : children) {
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  EXPECT_EQ(failures, 0);
  EXPECT_EQ(entries(), 1u);
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
