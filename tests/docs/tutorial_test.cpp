// The tutorials do what they say: their files are written, their commands run in order, and every
// line that they show is looked for in what the commands print ("…" stands for anything).
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/scratch_folder.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

/// A fenced block: "toml clay.toml" and its lines.
struct Block {
  std::string language, file;
  std::string text;
};

std::vector<Block> blocks_of(const fs::path& page) {
  std::ifstream in(page);
  std::vector<Block> blocks;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (!inside) continue;
      std::istringstream head(line.substr(3));
      Block& block = blocks.emplace_back();
      head >> block.language >> block.file;
    } else if (inside) {
      blocks.back().text += line + "\n";
    }
  }
  return blocks;
}

bool matches(std::string_view line, std::string_view pattern) {
  constexpr std::string_view anything = "…";
  const std::size_t gap = pattern.find(anything);
  if (gap == std::string_view::npos) return line == pattern;
  if (!line.starts_with(pattern.substr(0, gap))) return false;
  const std::string_view rest = pattern.substr(gap + anything.size());
  for (std::size_t at = gap; at <= line.size(); ++at)
    if (matches(line.substr(at), rest)) return true;
  return false;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Standard output and error of a command in a folder, with `repose` on the path.
std::string output_of(const std::string& command, const fs::path& folder, int& status) {
  const std::string path = fs::path(REPOSE_COMMAND).parent_path().string();
  const std::string whole =
      "cd '" + folder.string() + "' && PATH='" + path + "':\"$PATH\" && { " + command + "; } 2>&1";
  std::string text;
  FILE* const pipe = ::popen(whole.c_str(), "r");
  if (pipe == nullptr) return "no pipe";
  std::array<char, 4096> part{};
  for (std::size_t n = 0; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
    text.append(part.data(), n);
  status = ::pclose(pipe);
  return text;
}

class Tutorial : public testing::TestWithParam<const char*> {};

TEST_P(Tutorial, DoesWhatItSays) {
  const fs::path page = fs::path(REPOSE_SOURCE_DIR) / "docs/tutorials" / GetParam();
  const ScratchFolder scratch;
  std::string printed;
  int commands = 0, shown = 0;
  for (const Block& block : blocks_of(page)) {
    if (!block.file.empty()) {
      std::ofstream(scratch.path() / block.file) << block.text;
    } else if (block.language == "sh") {
      printed.clear();
      for (const std::string& command : lines_of(block.text)) {
        int status = 0;
        const std::string text = output_of(command, scratch.path(), status);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << command << "\n" << text;
        printed += text;
        ++commands;
      }
    } else if (block.language == "text") {
      const std::vector<std::string> lines = lines_of(printed);
      for (const std::string& wanted : lines_of(block.text)) {
        EXPECT_TRUE(std::any_of(lines.begin(), lines.end(),
                                [&](const std::string& line) { return matches(line, wanted); }))
            << wanted << "\nis not in\n"
            << printed;
        ++shown;
      }
    }
  }
  EXPECT_GE(commands, 3);
  EXPECT_GE(shown, 4);
}

INSTANTIATE_TEST_SUITE_P(
    Pages, Tutorial, testing::Values("drive.md", "fit.md", "collapse.md"), [](const auto& page) {
      return std::string(page.param).substr(0, std::string(page.param).find('.'));
    });

}  // namespace
}  // namespace repose
