#include "umat/out/host.hpp"

#include <cstdio>
#include <cstdlib>
#include <mutex>

// Utility routines of Abaqus/Standard (its User Subroutines Guide, "Utility Routines"), null where
// the host has none. Lengths of Fortran's character arguments follow the others.
extern "C" {
[[gnu::weak, gnu::visibility("default")]] void stdb_abqerr_(const int* lop, const char* message,
                                                            const int* integers,
                                                            const double* reals, const char* words,
                                                            std::size_t message_length,
                                                            std::size_t word_length);
[[gnu::weak, gnu::visibility("default")]] void xit_();
}

namespace repose::umat {
namespace {

/// As STDB_ABQERR takes it: at most 500 characters, in which % announces a number or a word.
std::string for_message_file(std::string text) {
  constexpr std::size_t longest = 500;
  for (std::size_t at = text.find('%'); at != std::string::npos; at = text.find('%', at))
    text.replace(at, 1, "per cent");
  if (text.size() > longest) text = text.substr(0, longest - 4) + " ...";
  return text;
}

}  // namespace

void stop(const std::string& message) {
  static std::mutex one_at_a_time;  // an exit that two threads begin has no defined end
  const std::lock_guard lock(one_at_a_time);
  if (stdb_abqerr_ != nullptr) {
    constexpr int error_that_stops = -3;
    constexpr int no_integer = 0;
    constexpr double no_real = 0.0;
    const std::string text = for_message_file(message);
    stdb_abqerr_(&error_that_stops, text.data(), &no_integer, &no_real, "        ", text.size(), 8);
  } else {
    std::fputs((message + "\n").c_str(), stderr);
  }
  if (xit_ != nullptr)
    xit_();
  else if (stdb_abqerr_ == nullptr)
    std::exit(2);
}

}  // namespace repose::umat
