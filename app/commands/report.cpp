#include <filesystem>

#include <fmt/core.h>

#include "app/commands/command.hpp"
#include "input/input_file.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/page/write_report.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;

io::ExitCode report(const std::vector<std::string>& folders, const CommonOptions& options) {
  const fs::path page = options.output.empty() ? io::ResultFolder::default_path("report.html")
                                               : fs::path(options.output);
  if (fs::is_directory(page))
    throw input::BadInput({fmt::format("-o {}: is a folder; give the page a name: -o {}",
                                       options.output, (page / "report.html").string())});
  std::vector<fs::path> results;
  for (const std::string& folder : folders)
    // results/* names the older page as well
    if (!fs::is_regular_file(folder))
      results.emplace_back(folder);
    else if (!options.quiet)
      fmt::print(stderr, "note: {} is a file, left out\n", folder);
  if (results.empty())
    throw input::BadInput({"repose report takes result folders, and none is given"});
  const report::WrittenReport written = report::write_report(results, page);
  const double megabytes = static_cast<double>(written.bytes) / 1e6;
  if (options.json)
    fmt::print("{}\n", Json{{"event", "done"},
                            {"page", page.string()},
                            {"results", written.results},
                            {"bytes", written.bytes}}
                           .dump());
  else if (!options.quiet)
    fmt::print("{}: {} result{}, {:.1f} MB; any browser opens it\n", page.string(), written.results,
               written.results == 1 ? "" : "s", megabytes);
  return io::ExitCode::done;
}

}  // namespace

Command add_report(CLI::App& root) {
  Verb verb(root, "report", "One HTML page from result folders");
  verb.footer(
      "Examples:\n"
      "  repose report results/flat_mu_i                     one run: animation, curves, input\n"
      "  repose report results/fine results/coarse -o compare.html    in the same axes\n"
      "  repose report results/*                             everything, by kind\n"
      "Takes folders of run, point, fit and chart. The page is one file without links: it can be\n"
      "sent by mail and opens without a network.");
  const auto options = std::make_shared<CommonOptions>();
  const auto folders = std::make_shared<std::vector<std::string>>();
  verb.required("DIR", *folders, "Result folders; several of a kind are compared", "...");
  verb.option("-o,--output", options->output, "The page (default: results/report.html)",
              "FILE.html");
  add_quiet(verb, *options);
  return {verb.app(), options, [options, folders] { return report(*folders, *options); }};
}

}  // namespace repose::app
