#include "umat/in/installation.hpp"

namespace repose::umat {

namespace fs = std::filesystem;

std::vector<fs::path> places(std::string_view beside, std::string_view below) {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  std::vector<fs::path> found;
  if (!beside.empty()) found.push_back(program / beside);
  for (const fs::path& prefix :
       {program.parent_path(), program.parent_path().parent_path().parent_path()}) {
    if (!beside.empty()) found.push_back(prefix / "bin" / beside);
    found.push_back(prefix / below);
  }
  return found;
}

}  // namespace repose::umat
