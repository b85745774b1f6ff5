#pragma once
/// \file
/// A fuzzer's corpus through the fuzzer's own checks, without the fuzzer: every file, every cut of
/// it, and 20 000 changes of up to four bytes.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

inline int replay(const std::string& bytes) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// Of tests/fuzz/corpus/<name>, which has `least` files at least. Text (no byte 0 behind the first,
/// which says what the rest is) gets these letters, and now and then one more; other files any
/// byte.
inline void replay_corpus(const std::string& name, std::string_view letters, int least) {
  std::mt19937 random(1);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  int count = 0;
  const std::filesystem::path corpus =
      std::string(REPOSE_SOURCE_DIR) + "/tests/fuzz/corpus/" + name;
  for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    SCOPED_TRACE(entry.path().filename().string());
    const bool is_text = bytes.find('\0', 1) == std::string::npos;
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
  EXPECT_GE(count, least);
}
