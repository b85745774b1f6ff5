/// The house as the code has it against tests/architecture/arrows.txt.
#include <algorithm>
#include <cctype>
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

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// What is said on a terminal is said in app/; below it only a run of a scene and its progress line
/// speak, and the UMAT in a program that has no message file.
TEST(House, OnlyTheCommandPrints) {
  const std::vector<std::string> speak{"io/progress.cpp", "study/run/run_scene.cpp",
                                       "umat/out/host.cpp"};
  std::vector<std::string> found;
  for (const Source& source : sources(read_arrows())) {
    if (lies_in(source.path, "app")) continue;
    std::istringstream text(text_of(root / source.path));
    std::string code;  // without comments: a sample in one may print
    for (std::string line; std::getline(text, line);)
      if (line.find("//") != line.find_first_not_of(' ')) code += line + "\n";
    for (const char* const call : {"fmt::print(", "std::printf(", "std::puts(", "std::fputs(",
                                   "std::fprintf(", "std::cout", "std::cerr"})
      if (code.find(call) != std::string::npos) {
        found.push_back(source.path);
        break;
      }
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, speak);
}

/// docs/architecture.md, line by line.
std::vector<std::string> page() {
  std::vector<std::string> lines;
  std::ifstream in(root / "docs/architecture.md");
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// What stands in `...` on a line.
std::vector<std::string> code_of(const std::string& line) {
  std::vector<std::string> spans;
  for (std::size_t from = line.find('`'); from != std::string::npos;) {
    const std::size_t to = line.find('`', from + 1);
    if (to == std::string::npos) break;
    spans.push_back(line.substr(from + 1, to - from - 1));
    from = line.find('`', to + 1);
  }
  return spans;
}

bool is_file_name(const std::string& text) {
  static const std::vector<std::string> types{".hpp", ".cpp", ".inc", ".toml",
                                              ".csv", ".md",  ".txt"};
  return text.find('/') != std::string::npos && text.find(' ') == std::string::npos &&
         std::any_of(types.begin(), types.end(),
                     [&](const std::string& type) { return text.ends_with(type); });
}

TEST(ArchitecturePage, ItsMapIsThatOfTheArrows) {
  std::vector<std::string> on_page, in_file;
  bool inside = false;
  for (const std::string& line : page()) {
    if (line.starts_with("```")) {
      inside = line == "```rooms";
      continue;
    }
    if (!inside || line.empty()) continue;
    std::istringstream words(line);
    std::string room, arrow, all;
    words >> room >> arrow;
    EXPECT_EQ(arrow, "←") << line;
    for (std::string name; words >> name;) all += " " + name;
    on_page.push_back(room + ":" + all);
  }
  for (const Room& room : read_arrows()) {
    std::string all;
    for (const std::string& name : room.may_include) all += " " + name;
    in_file.push_back(room.name + ":" + all);
  }
  EXPECT_EQ(on_page, in_file);
}

TEST(ArchitecturePage, EveryRoomHasItsParagraph) {
  const std::vector<std::string> lines = page();
  for (const Room& room : read_arrows())
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                            [&](const std::string& line) {
                              return line.starts_with("**" + room.name + "** ");
                            }),
              1)
        << room.name;
}

TEST(ArchitecturePage, EveryFileItNamesIsThere) {
  std::size_t names = 0;
  for (const std::string& line : page()) {
    for (const std::string& name : code_of(line)) {
      if (!is_file_name(name)) continue;
      ++names;
      EXPECT_TRUE(fs::exists(root / name)) << name;
    }
    for (std::size_t at = line.find("]("); at != std::string::npos; at = line.find("](", at + 1)) {
      const std::string link = line.substr(at + 2, line.find(')', at) - at - 2);
      ++names;
      EXPECT_TRUE(fs::exists(root / "docs" / link)) << link;
    }
  }
  EXPECT_GT(names, 40U) << "hardly a file was found: are they written in another way?";
}

/// A walk's steps, each as one line.
struct Walk {
  std::string title;
  std::vector<std::string> steps;
};

std::vector<Walk> walks() {
  std::vector<Walk> list;
  for (const std::string& line : page()) {
    if (line.starts_with("### ")) list.push_back({line.substr(4), {}});
    if (list.empty() || line.empty()) continue;
    if (std::isdigit(static_cast<unsigned char>(line.front())) != 0)
      list.back().steps.push_back(line);
    else if (line.starts_with("   ") && !list.back().steps.empty())
      list.back().steps.back() += line.substr(2);
  }
  return list;
}

TEST(ArchitecturePage, NoWalkVisitsARoomTwice) {
  const std::vector<Room> rooms = read_arrows();
  const std::vector<Walk> all = walks();
  ASSERT_EQ(all.size(), 4U);
  for (const Walk& walk : all) {
    EXPECT_GE(walk.steps.size(), 5U) << walk.title;
    std::vector<std::string> visited;
    for (const std::string& step : walk.steps) {
      const std::vector<std::string> code = code_of(step);
      ASSERT_FALSE(code.empty()) << step;
      ASSERT_TRUE(is_file_name(code.front())) << step;
      const Room* const room = room_of(rooms, code.front());
      ASSERT_NE(room, nullptr) << step;
      if (!visited.empty() && visited.back() == room->name) continue;
      EXPECT_EQ(std::count(visited.begin(), visited.end(), room->name), 0)
          << walk.title << " comes back to " << room->name << ": " << step;
      visited.push_back(room->name);
    }
  }
}

TEST(ArchitecturePage, TheFunctionsOfAStepAreInItsFiles) {
  std::size_t functions = 0;
  for (const Walk& walk : walks())
    for (const std::string& step : walk.steps) {
      std::string text;
      for (const std::string& name : code_of(step))
        if (is_file_name(name)) text += text_of(root / name);
      for (const std::string& name : code_of(step)) {
        if (!name.ends_with("()")) continue;
        ++functions;
        const std::string call = name.substr(0, name.size() - 2);
        std::size_t at = text.find(call);
        const auto in_a_word = [](char c) {
          return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
        };
        // as a whole word that a parenthesis or a template's arguments follow
        const auto is_it = [&](std::size_t i) {
          const std::size_t end = i + call.size();
          return (i == 0 || !in_a_word(text[i - 1])) && end < text.size() &&
                 (text[end] == '(' || text[end] == '<');
        };
        while (at != std::string::npos && !is_it(at)) at = text.find(call, at + 1);
        EXPECT_NE(at, std::string::npos)
            << walk.title << ": no " << name << " in the files of: " << step;
      }
    }
  EXPECT_GT(functions, 25U);
}

}  // namespace
}  // namespace repose
