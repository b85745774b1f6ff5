// The inputs of the fuzzer's corpus, and some made here, through the fuzzer's own checks.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

int replay(const std::string& bytes) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

TEST(MeasuredTableReplay, every_input_of_the_corpus) {
  int count = 0;
  const std::filesystem::path corpus =
      std::string(REPOSE_SOURCE_DIR) + "/tests/fuzz/corpus/measured_table";
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    SCOPED_TRACE(entry.path().filename().string());
    EXPECT_EQ(replay(bytes), 0);
    // every cut of it, as a full disk leaves them
    for (std::size_t n = 0; n < bytes.size(); ++n) replay(bytes.substr(0, n));
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST(MeasuredTableReplay, every_byte_in_every_place) {
  const std::string table = std::string(1, '\0') + "a;\"b [%]\"\n%;kPa\n1,5;-\n\"2\";3e4\n";
  for (std::size_t i = 1; i < table.size(); ++i)
    for (int byte = 0; byte < 256; ++byte) {
      std::string changed = table;
      changed[i] = static_cast<char>(byte);
      EXPECT_EQ(replay(changed), 0);
    }
}

}  // namespace
