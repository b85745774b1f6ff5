#pragma once
/// \file
/// What the posterior of a fit leaves in files: posterior.json, posterior.csv, posterior_bands.csv,
/// and the chains' journal that a resumed or merged fit takes up.

#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "study/fit/sampling.hpp"

namespace repose::study {

/// The text of posterior.json. status: "done" or "not converged".
io::Json posterior_report(const input::FitFile& file, const Sampler& sampler,
                          const PosteriorResult& result);

/// posterior.csv: a line per kept draw, every quantity in SI.
std::string draws_csv(const input::FitFile& file, const PosteriorResult& result);

/// posterior_bands.csv: median and 90 % bands beside what was measured, row by row, in SI.
std::string bands_csv(const input::FitFile& file, const PosteriorResult& result);

/// All three into the folder of the fit.
void write_posterior(const io::ResultFolder& folder, const input::FitFile& file,
                     const Sampler& sampler, const PosteriorResult& result);

/// What `repose fit` tells of it, line by line.
std::vector<std::string> posterior_words(const input::FitFile& file, const PosteriorResult& result);

/// The journal of chains (journal.hpp): its head names what they are drawn from, then a line per
/// draw.
std::string chains_journal(const input::FitFile& file, const Sampler& sampler,
                           const std::vector<calibration::Draw>& draws);
std::string journal_line(const calibration::Draw& draw);
/// The draws of several journals, absent ones being empty. Errors: BadInput if the chains are drawn
/// from something else, or the same draw is another one in two of them; IoError if one cannot be
/// read.
std::vector<calibration::Draw> read_chains(const std::vector<std::filesystem::path>& journals,
                                           const Sampler& sampler);
/// Where a fit keeps its draws; whether there is one in any of these folders.
inline constexpr std::string_view chains_name = "chains.jsonl";
bool have_chains(const std::vector<std::string>& folders);
/// The draws that these folders, and that of the fit if it is resumed, hold, which go into its
/// journal. Errors: as read_chains; IoError.
std::vector<calibration::Draw> begin_sampling(const io::ResultFolder& folder,
                                              const input::FitFile& file, const Sampler& sampler,
                                              const std::vector<std::string>& merge, bool resume);

/// Leaves a share of the chains to be drawn, all from `from` if `to` is −1, and none where they are
/// `merged`: then what was drawn is all there is. Errors: BadInput for a share that there is not,
/// and for one of a fit that has not all its starts.
void share_chains(input::FitFile& file, int from, int to, bool merged);

}  // namespace repose::study
