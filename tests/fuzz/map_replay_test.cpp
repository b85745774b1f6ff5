// The maps of the fuzzer's corpus, every cut of them, and changes of them, through the fuzzer's own
// checks.
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

TEST(MapReplay, EveryMapOfTheCorpusItsCutsAndItsChanges) {
  static const std::string letters = "0123456789.-+eE,[]{}\":\n nacN\xff";
  std::mt19937 random(1);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  int count = 0;
  const std::filesystem::path corpus = std::string(REPOSE_SOURCE_DIR) + "/tests/fuzz/corpus/map";
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    SCOPED_TRACE(entry.path().filename().string());
    EXPECT_EQ(replay(bytes), 0);
    for (std::size_t n = 0; n < bytes.size(); ++n) replay(bytes.substr(0, n));
    for (int k = 0; k < 20000; ++k) {
      std::string changed = bytes;
      for (std::size_t edits = 1 + below(4); edits-- > 0;) {
        const std::size_t at = 1 + below(changed.size() - 1);
        if (below(3) == 0)
          changed.insert(at, 1, letters[below(letters.size())]);
        else
          changed[at] = letters[below(letters.size())];
      }
      EXPECT_EQ(replay(changed), 0);
    }
    ++count;
  }
  EXPECT_GE(count, 6);
}

// What is nested deeply ends in a message, not in the stack's end.
TEST(MapReplay, DeepNesting) {
  for (const int deep : {100, 10000}) {
    std::string json = "\1";
    for (int k = 0; k < deep; ++k) json += R"({"type":"Feature","geometry":)";
    json += "null";
    json.append(static_cast<std::size_t>(deep), '}');
    EXPECT_EQ(replay(json), 0);
    EXPECT_EQ(replay("\1" + std::string(static_cast<std::size_t>(deep), '[')), 0);
  }
}

}  // namespace
