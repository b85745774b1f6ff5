// The inputs of the corpus, and files made here by the fuzzer's own mutator, through its checks:
// REPOSE_FUZZ_RUNS says how many of each kind.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "io/seal.hpp"
#include "tests/fuzz/input_mutator.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace repose::fuzz {
namespace {

int replay(const std::string& bytes) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::vector<std::string> corpus() {
  std::vector<std::string> texts;
  const std::filesystem::path folder = std::string(REPOSE_SOURCE_DIR) + "/tests/fuzz/corpus/input";
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    texts.push_back(io::read_bytes(entry.path()));
  std::sort(texts.begin(), texts.end());
  return texts;
}

int runs() {
  const char* const asked = std::getenv("REPOSE_FUZZ_RUNS");
  return asked != nullptr ? std::atoi(asked) : 150;
}

TEST(InputReplay, every_input_of_the_corpus) {
  int count = 0;
  for (const std::string& text : corpus()) {
    SCOPED_TRACE(text.substr(0, 60));
    EXPECT_EQ(replay(text), 0);
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST(InputReplay, files_made_of_known_keys) {
  const InputMutator mutator;
  Random random(20261129);
  for (std::size_t kind = 0; kind < mutator.kinds(); ++kind)
    for (int k = 0; k < runs(); ++k) EXPECT_EQ(replay(mutator.made_up(kind, random)), 0);
}

TEST(InputReplay, sound_files_with_changes) {
  const InputMutator mutator;
  Random random(7);
  for (const std::string& text : corpus())
    for (int k = 0; k < runs() / 3; ++k) {
      std::string changed = mutator.changed(text, random);
      if (random() % 3 == 0) changed = mutator.changed(changed, random);
      EXPECT_EQ(replay(changed), 0);
    }
}

}  // namespace
}  // namespace repose::fuzz
