#pragma once
/// \file
/// What the posterior of a fit leaves in files: posterior.json, posterior.csv, posterior_bands.csv,
/// and the chains' journal that a resumed or merged fit takes up.

#include "io/json.hpp"
#include "study/fit/sampling.hpp"

namespace repose::study {

/// The text of posterior.json. status: "done" or "not converged".
io::Json posterior_report(const input::FitFile& file, const Sampler& sampler,
                          const PosteriorResult& result);

/// posterior.csv: a line per kept draw, every quantity in SI.
std::string draws_csv(const input::FitFile& file, const PosteriorResult& result);

/// posterior_bands.csv: median and 90 % bands beside what was measured, row by row, in SI.
std::string bands_csv(const input::FitFile& file, const PosteriorResult& result);

/// One line per draw, and back (journal.hpp); its head names what the chains are drawn from.
std::string chains_head(const input::FitFile& file, const Sampler& sampler);
std::string journal_line(const calibration::Draw& draw);
/// Errors: BadInput if the chains are drawn from something else; IoError if the journal cannot be
/// read. An absent file is an empty journal.
std::vector<calibration::Draw> read_chains(const std::filesystem::path& path,
                                           const Sampler& sampler);
/// Adds draws that are not there yet. Errors: BadInput if the same draw is another one.
void merge_into(std::vector<calibration::Draw>& all, std::vector<calibration::Draw> more,
                const std::string& from);

}  // namespace repose::study
