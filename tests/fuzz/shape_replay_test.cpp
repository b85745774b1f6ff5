// The files of the fuzzer's corpus, every cut of them, and changes of them, through the fuzzer's
// own checks.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include <gtest/gtest.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

int replay(const std::string& bytes) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(ShapeReplay, EveryFileOfTheCorpusItsCutsAndItsChanges) {
  std::mt19937 random(1);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  int count = 0;
  const std::filesystem::path corpus = std::string(REPOSE_SOURCE_DIR) + "/tests/fuzz/corpus/shape";
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    SCOPED_TRACE(entry.path().filename().string());
    const bool is_text = bytes.find('\0', 1) == std::string::npos;
    static const std::string letters = "0123456789.-+eE,;[]\n nacN\xff";
    EXPECT_EQ(replay(bytes), 0);
    for (std::size_t n = 0; n < bytes.size(); ++n) replay(bytes.substr(0, n));
    for (int k = 0; k < 20000; ++k) {
      std::string changed = bytes;
      for (std::size_t edits = 1 + below(4); edits-- > 0;) {
        const std::size_t at = 1 + below(changed.size() - 1);
        const char letter =
            is_text ? letters[below(letters.size())] : static_cast<char>(below(256));
        if (is_text && below(3) == 0)
          changed.insert(at, 1, letter);
        else
          changed[at] = letter;
      }
      EXPECT_EQ(replay(changed), 0);
    }
    ++count;
  }
  EXPECT_GE(count, 5);
}

}  // namespace
