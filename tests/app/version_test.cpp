#include <string>

#include <gtest/gtest.h>

#include "repose_version.hpp"

// The printed version starts with the release's number and, inside a checkout, names the revision.
TEST(Version, string_holds_release_and_revision) {
  const std::string release = repose::version;
  const std::string revision = repose::revision;
  const std::string expected = revision.empty() ? release : release + " (" + revision + ")";
  EXPECT_EQ(repose::version_string, expected);
}

TEST(Version, release_is_three_numbers) {
  int dots = 0;
  for (const char c : std::string(repose::version)) {
    EXPECT_TRUE(c == '.' || (c >= '0' && c <= '9')) << repose::version;
    dots += c == '.';
  }
  EXPECT_EQ(dots, 2) << repose::version;
}
