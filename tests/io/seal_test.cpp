#include "io/seal.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "io/atomic_file.hpp"
#include "io/result_folder.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::io {
namespace {

void put(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(SealTest, EveryCutAndEveryChangedByteIsNoticed) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "f";
  const std::string content("a\0b and some more", 17);
  const std::string whole = content + seal_of(content);
  put(file, whole);
  EXPECT_EQ(read_sealed(file), content);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    put(file, whole.substr(0, n));
    EXPECT_THROW(read_sealed(file), IoError) << n;
    for (const int bit : {1, 32}) {
      std::string changed = whole;
      changed[n] = static_cast<char>(changed[n] ^ bit);
      put(file, changed);
      EXPECT_THROW(read_sealed(file), IoError) << n;
    }
  }
  put(file, whole + seal_of(whole));  // sealed twice: the content is what was sealed
  EXPECT_EQ(read_sealed(file), whole);
  EXPECT_THROW(read_sealed(folder.path() / "absent"), IoError);
}

TEST(ManifestTest, TellsWhatIsNotAsItWasWritten) {
  const ScratchFolder scratch;
  const ResultFolder folder(scratch.path());
  EXPECT_EQ(folder.damage(), "there is no manifest.json");
  folder.write_file("series.csv", "a,b\n1,2\n");
  folder.write_file("summary.json", "{}");
  std::filesystem::create_directories(folder.frames());
  put(folder.frames() / "x_00000.hdf", "frame");
  put(scratch.path() / "notes.txt", "somebody else's");
  folder.seal();
  EXPECT_EQ(folder.damage(), "");
  put(scratch.path() / "notes.txt", "and changed");
  EXPECT_EQ(folder.damage(), "");
  put(folder.file("series.csv"), "a,b\n1,3\n");
  EXPECT_EQ(folder.damage(), "series.csv is not as it was written");
  EXPECT_EQ(folder.damage(std::vector<std::string>{"summary.json"}), "");
  EXPECT_EQ(folder.damage(std::vector<std::string>{"table.csv"}),
            "table.csv is not in manifest.json");
  put(folder.file("series.csv"), "a,b\n1,2\n");
  EXPECT_EQ(folder.damage(), "");
  put(folder.frames() / "x_00000.hdf", "fra");
  EXPECT_EQ(folder.damage(), "frames/x_00000.hdf is not as it was written");
  std::filesystem::remove(folder.frames() / "x_00000.hdf");
  EXPECT_EQ(folder.damage(), "frames/x_00000.hdf is missing");
  put(folder.file("manifest.json"), "{\"files\": 3");
  EXPECT_EQ(folder.damage(), "manifest.json is damaged");
  folder.remove_old_outputs();
  EXPECT_EQ(folder.damage(), "there is no manifest.json");
}

}  // namespace
}  // namespace repose::io
