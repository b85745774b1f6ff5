#pragma once
/// \file
/// Starting the program, ending it at some moment, and comparing what it left.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/scratch_folder.hpp"

namespace repose {

/// repose with these arguments, begun in a folder; what it prints is lost, and if `silent` what it
/// complains of too.
inline pid_t start(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                   bool silent = false) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  if (::chdir(folder.c_str()) != 0) ::_exit(100);
  if (std::freopen("/dev/null", "w", stdout) == nullptr) ::_exit(102);
  if (silent && std::freopen("/dev/null", "w", stderr) == nullptr) ::_exit(102);
  std::vector<char*> argv{const_cast<char*>("repose")};
  for (const std::string& one : arguments) argv.push_back(const_cast<char*>(one.c_str()));
  argv.push_back(nullptr);
  ::execv(REPOSE_COMMAND, argv.data());
  ::_exit(101);
}

/// The exit code, or less than zero the signal that ended it.
inline int ended(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Every file of a result by name, hidden ones too.
inline std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[std::filesystem::relative(entry.path(), folder).string()] = content_of(entry.path());
  return files;
}

/// REPOSE_KILLS, or what the ordinary tests take.
inline int kills_wanted(int usual) {
  const char* const asked = std::getenv("REPOSE_KILLS");
  return asked != nullptr ? std::atoi(asked) : usual;
}

}  // namespace repose
