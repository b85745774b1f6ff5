/// The house as the code has it against tests/architecture/arrows.txt.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace repose {
namespace {

namespace fs = std::filesystem;

const fs::path root = REPOSE_SOURCE_DIR;

struct Room {
  std::string name;
  std::vector<std::string> may_include;
};

/// Whether `path`, a file or a room, lies in a room or is it.
bool lies_in(std::string_view path, std::string_view room) {
  return path.starts_with(room) && (path.size() == room.size() || path[room.size()] == '/');
}

std::vector<Room> read_arrows() {
  std::vector<Room> rooms;
  std::ifstream in(root / "tests/architecture/arrows.txt");
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) throw std::runtime_error("arrows.txt: no colon in " + line);
    Room room{line.substr(0, colon), {}};
    std::istringstream names(line.substr(colon + 1));
    for (std::string name; names >> name;) room.may_include.push_back(name);
    rooms.push_back(std::move(room));
  }
  return rooms;
}

/// The room of a file; null for one in none.
const Room* room_of(const std::vector<Room>& rooms, std::string_view path) {
  const Room* found = nullptr;
  for (const Room& room : rooms)
    if (lies_in(path, room.name) && (found == nullptr || room.name.size() > found->name.size()))
      found = &room;
  return found;
}

struct Source {
  std::string path;
  std::vector<std::string> includes;  ///< of ours
  long lines = 0;
};

/// Every source of the program: what lies in the folders of the rooms.
std::vector<Source> sources(const std::vector<Room>& rooms) {
  std::vector<std::string> folders;
  for (const Room& room : rooms) {
    const std::string top = room.name.substr(0, room.name.find('/'));
    if (std::find(folders.begin(), folders.end(), top) == folders.end()) folders.push_back(top);
  }
  std::vector<Source> list;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string type = entry.path().extension().string();
      if (type != ".hpp" && type != ".cpp" && type != ".inc") continue;
      Source source{entry.path().lexically_relative(root).generic_string(), {}, 0};
      std::ifstream in(entry.path());
      constexpr std::string_view start = "#include \"";
      for (std::string line; std::getline(in, line); ++source.lines)
        if (line.starts_with(start)) {
          const std::string path =
              line.substr(start.size(), line.find('"', start.size()) - start.size());
          if (path.find('/') != std::string::npos) source.includes.push_back(path);
        }
      list.push_back(std::move(source));
    }
  return list;
}

TEST(House, EveryArrowPointsToARoomFurtherDown) {
  std::vector<std::string> above;
  for (const Room& room : read_arrows()) {
    for (const std::string& target : room.may_include)
      EXPECT_TRUE(std::any_of(above.begin(), above.end(),
                              [&](const std::string& name) { return lies_in(name, target); }))
          << room.name << " may include " << target << ", which stands in no line above it";
    above.push_back(room.name);
  }
  EXPECT_GE(above.size(), 9U) << "arrows.txt was not read";
}

TEST(House, NoIncludeRunsUp) {
  const std::vector<Room> rooms = read_arrows();
  std::size_t arrows = 0;
  for (const Source& source : sources(rooms)) {
    const Room* const from = room_of(rooms, source.path);
    ASSERT_NE(from, nullptr) << source.path << " lies in no room of arrows.txt";
    for (const std::string& path : source.includes) {
      const Room* const to = room_of(rooms, path);
      ASSERT_NE(to, nullptr) << source.path << " includes " << path << ", which lies in no room";
      EXPECT_TRUE(fs::exists(root / path)) << source.path << " includes " << path;
      if (from == to) continue;
      ++arrows;
      EXPECT_TRUE(std::any_of(from->may_include.begin(), from->may_include.end(),
                              [&](const std::string& name) { return lies_in(to->name, name); }))
          << source.path << " includes " << path << ": " << from->name << " may not include "
          << to->name;
    }
  }
  EXPECT_GT(arrows, 100U) << "hardly an include was found: are they written in another way?";
}

TEST(House, NoFileIncludesItself) {
  const std::vector<Source> files = sources(read_arrows());
  std::map<std::string, const Source*> by_path;
  for (const Source& source : files) by_path[source.path] = &source;
  std::map<std::string, int> state;  // 1: on the way, 2: done
  std::vector<std::string> way;
  const std::function<void(const std::string&)> visit = [&](const std::string& path) {
    const auto found = by_path.find(path);
    if (found == by_path.end() || state[path] == 2) return;
    way.push_back(path);
    std::string circle;
    for (const std::string& file : way) circle += "\n  " + file;
    ASSERT_NE(state[path], 1) << "a circle of includes:" << circle;
    state[path] = 1;
    for (const std::string& next : found->second->includes) visit(next);
    state[path] = 2;
    way.pop_back();
  };
  for (const Source& source : files) visit(source.path);
}

/// No room is so big that it cannot be seen as a whole: a quarter of the code at most; app/ parses,
/// calls and prints.
TEST(House, NoRoomIsTooBig) {
  std::map<std::string, long> lines;
  long all = 0;
  for (const Source& source : sources(read_arrows())) {
    lines[source.path.substr(0, source.path.find('/'))] += source.lines;
    all += source.lines;
  }
  for (const auto& [room, count] : lines) {
    RecordProperty(room, std::to_string(count));
    EXPECT_LT(4 * count, all) << room << "/ holds " << count << " of " << all << " lines";
  }
  EXPECT_LT(lines["app"], 3500);
}

}  // namespace
}  // namespace repose
