// Damage to what a run reads back: every cut and every flipped byte of a checkpoint and a frame is
// noticed, and so is a checkpoint whose arrays do not belong together, whatever its checksum says.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "io/seal.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

int replay(const std::string& bytes) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(StateReplay, random_changes_of_the_arrays_of_a_checkpoint) {
  const char* const asked = std::getenv("REPOSE_FUZZ_RUNS");
  const int runs = asked != nullptr ? std::atoi(asked) : 600;
  std::mt19937_64 random(20261129);
  for (int k = 0; k < runs; ++k) {
    std::string bytes(1, '\3');
    for (std::size_t n = 12 * (1 + random() % 3); n > 0; --n)
      bytes.push_back(static_cast<char>(random()));
    replay(bytes);
  }
}

TEST(StateReplay, every_input_of_the_corpus) {
  const std::filesystem::path corpus = std::string(REPOSE_SOURCE_DIR) + "/tests/fuzz/corpus/state";
  if (!std::filesystem::exists(corpus)) return;
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    SCOPED_TRACE(entry.path().filename().string());
    EXPECT_EQ(replay(repose::io::read_bytes(entry.path())), 0);
  }
}

TEST(StateReplay, bytes_that_nobody_wrote) {
  std::mt19937_64 random(1);
  for (int kind = 0; kind < 3; ++kind)
    for (int k = 0; k < 2000; ++k) {
      std::string bytes(1, static_cast<char>(kind));
      for (std::size_t n = random() % 200; n > 0; --n) bytes.push_back(static_cast<char>(random()));
      replay(bytes);
    }
}

}  // namespace
