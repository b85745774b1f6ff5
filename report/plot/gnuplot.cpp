#include "report/plot/gnuplot.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>
#include <thread>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace repose::report {

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::string system_message(int error) { return std::generic_category().message(error); }

/// A nameless file. gnuplot's three streams are such files and not pipes, so that neither side can
/// wait for the other for ever.
File scratch_file() {
  File file(std::tmpfile(), std::fclose);
  if (!file) throw PlotError("no temporary file for gnuplot: " + system_message(errno));
  return file;
}

std::string read_back(const File& file) {
  std::string content;
  std::rewind(file.get());
  std::array<char, 65536> block;
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get()))
    content.append(block.data(), count);
  return content;
}

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  void connect(const File& file, int stream) {
    posix_spawn_file_actions_adddup2(&actions_, ::fileno(file.get()), stream);
  }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

/// What waitpid says about a child's end. One that is not done within the limit is killed: a
/// picture is never worth a wait without end.
int status_of(pid_t child, std::chrono::milliseconds limit) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  auto pause = std::chrono::microseconds(200);
  int status = 0;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) throw PlotError("gnuplot is lost: " + system_message(errno));
    if (Clock::now() - begin > limit) {
      ::kill(child, SIGKILL);
      while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
      }
      throw PlotError(
          "gnuplot was not done after " +
          std::to_string(std::chrono::duration_cast<std::chrono::seconds>(limit).count()) +
          " s and has been stopped");
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::microseconds(10000));
  }
}

/// Starts gnuplot and returns what waitpid says about its end.
int run_to_end(const SpawnActions& actions, std::chrono::milliseconds limit) {
  std::string name = "gnuplot", no_startup_files = "-d", from_stdin = "-";
  const std::array<char*, 4> arguments{name.data(), no_startup_files.data(), from_stdin.data(),
                                       nullptr};
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, "gnuplot", actions.get(), nullptr, arguments.data(), environ);
  if (error == ENOENT)
    throw PlotError("gnuplot is not installed (Debian: apt-get install gnuplot-nox)");
  if (error != 0) throw PlotError("gnuplot does not start: " + system_message(error));
  return status_of(child, limit);
}

/// The length of the UTF-8 character at the start of text; 0 if there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  // Leads 0xc0, 0xc1 would be overlong, those above 0xf4 beyond Unicode.
  const std::size_t length = lead < 0xc2   ? 0
                             : lead < 0xe0 ? 2
                             : lead < 0xf0 ? 3
                             : lead < 0xf5 ? 4
                                           : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const unsigned char second = byte(1);
  const bool overlong = (lead == 0xe0 && second < 0xa0) || (lead == 0xf0 && second < 0x90);
  const bool outside = (lead == 0xed && second >= 0xa0) || (lead == 0xf4 && second >= 0x90);
  return overlong || outside ? 0 : length;
}

/// Text without markup.
std::string literal(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text.front();
    if (length == 0) {
      out += "\uFFFD";
    } else if (length > 1) {
      out += text.substr(0, length);
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += ' ';
    } else if (c == '\'') {
      out += "''";  // as gnuplot writes a quote within single quotes
    } else {
      if (std::string_view("{}^_@&~\\").find(c) != std::string_view::npos) out += '\\';
      out += c;
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

/// Where the next _{...} or ^{...} begins; npos if there is none that ends.
std::size_t find_script(std::string_view text) {
  for (std::size_t i = 0; i + 1 < text.size(); ++i)
    if ((text[i] == '_' || text[i] == '^') && text[i + 1] == '{' &&
        text.find('}', i) != std::string_view::npos)
      return i;
  return std::string_view::npos;
}

}  // namespace

std::string run_gnuplot(std::string_view script, std::chrono::milliseconds limit) {
  const File input = scratch_file(), output = scratch_file(), messages = scratch_file();
  const bool written = std::fwrite(script.data(), 1, script.size(), input.get()) == script.size() &&
                       std::fflush(input.get()) == 0;
  if (!written) throw PlotError("no space for gnuplot's script: " + system_message(errno));
  std::rewind(input.get());

  SpawnActions actions;
  actions.connect(input, STDIN_FILENO);
  actions.connect(output, STDOUT_FILENO);
  actions.connect(messages, STDERR_FILENO);
  const int status = run_to_end(actions, limit);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    const std::string said = read_back(messages);
    throw PlotError("gnuplot failed: " + (said.empty() ? "without a message" : said), said);
  }
  return read_back(output);
}

std::string gnuplot_text(std::string_view text, bool bold) {
  std::string out = bold ? "'{/:Bold " : "'";
  while (!text.empty()) {
    const std::size_t script = find_script(text);
    out += literal(text.substr(0, script));
    if (script == std::string_view::npos) break;
    const std::size_t end = text.find('}', script);
    out += text[script];
    out += '{' + literal(text.substr(script + 2, end - script - 2)) + '}';
    text.remove_prefix(end + 1);
  }
  return out + (bold ? "}'" : "'");
}

}  // namespace repose::report
