#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/command.hpp"
#include "app/input_file.hpp"
#include "app/report/page.hpp"
#include "app/report/read_result.hpp"
#include "app/result_folder.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Two folders of one name are told apart by the paths that were given.
void tell_apart(std::vector<Json>& results) {
  std::vector<std::string> labels;
  for (const Json& result : results) labels.push_back(result["label"]);
  for (std::size_t i = 0; i < results.size(); ++i)
    if (std::count(labels.begin(), labels.end(), labels[i]) > 1)
      results[i]["label"] = results[i]["path"];
  // a page that is sent to others need not tell where its results lay
  for (Json& result : results) result.erase("path");
}

std::string title_of(const std::vector<Json>& results) {
  if (results.size() == 1) return results.front()["label"];
  if (results.size() == 2)
    return fmt::format("{} and {}", results[0]["label"].get<std::string>(),
                       results[1]["label"].get<std::string>());
  return fmt::format("{} and {} more results", results[0]["label"].get<std::string>(),
                     results.size() - 1);
}

ExitCode report(const std::vector<std::string>& folders, const CommonOptions& options) {
  const fs::path page =
      options.output.empty() ? ResultFolder::default_path("report.html") : fs::path(options.output);
  if (fs::is_directory(page))
    throw BadInput({fmt::format("-o {}: is a folder; give the page a name: -o {}", options.output,
                                (page / "report.html").string())});
  std::vector<Json> results;
  std::vector<fs::path> seen;
  for (const std::string& folder : folders) {
    // results/* names the older page as well
    if (fs::is_regular_file(folder)) {
      if (!options.quiet) fmt::print(stderr, "note: {} is a file, left out\n", folder);
      continue;
    }
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(folder, error);
    if (std::find(seen.begin(), seen.end(), whole) != seen.end()) continue;
    seen.push_back(whole);
    results.push_back(read_result(folder));
  }
  if (results.empty()) throw BadInput({"repose report takes result folders, and none is given"});
  tell_apart(results);
  const std::string text = report_page(results, title_of(results));
  const fs::path around = page.parent_path();
  std::error_code error;
  if (!around.empty()) fs::create_directories(around, error);
  if (error) throw IoError(around, "cannot create the folder", error.value());
  mpm::write_atomically(page, text);
  const double megabytes = static_cast<double>(text.size()) / 1e6;
  if (options.json)
    fmt::print("{}\n", Json{{"event", "done"},
                            {"page", page.string()},
                            {"results", results.size()},
                            {"bytes", text.size()}}
                           .dump());
  else if (!options.quiet)
    fmt::print("{}: {} result{}, {:.1f} MB; any browser opens it\n", page.string(), results.size(),
               results.size() == 1 ? "" : "s", megabytes);
  return ExitCode::done;
}

}  // namespace

Command add_report(CLI::App& root) {
  CLI::App* verb = root.add_subcommand("report", "One HTML page from result folders");
  verb->footer(
      "Examples:\n"
      "  repose report results/flat_mu_i                     one run: animation, curves, input\n"
      "  repose report results/fine results/coarse -o compare.html    in the same axes\n"
      "  repose report results/*                             everything, by kind\n"
      "Takes folders of run, point, fit and chart. The page is one file without links: it can be\n"
      "sent by mail and opens without a network.");
  const auto options = std::make_shared<CommonOptions>();
  const auto folders = std::make_shared<std::vector<std::string>>();
  verb->add_option("DIR", *folders, "Result folders; several of a kind are compared")
      ->type_name("...")
      ->required();
  verb->add_option("-o,--output", options->output, "The page (default: results/report.html)")
      ->type_name("FILE.html");
  add_quiet(*verb, *options);
  return {verb, options, [options, folders] { return report(*folders, *options); }};
}

}  // namespace repose::app
