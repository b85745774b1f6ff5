#pragma once
/// \file
/// A journal of a fit: one line of JSON for every start or draw that ended, appended whole, so that
/// a kill loses none before it. The first line tells whose it is; every other ends with a checksum.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "io/json.hpp"

namespace repose::study {

std::string journal_line(const io::Json& entry);

/// A number as JSON, null where it is not finite; a list of them, and back, null being NaN.
io::Json number(double x);
io::Json list(const Eigen::VectorXd& v);
Eigen::VectorXd vector_of(const io::Json& list);

/// Hands on every entry behind the head. One that was cut short, or is not as it was written by its
/// checksum, is ignored with those behind it. An absent file is an empty journal. what: "start".
/// Errors: BadInput if the head has another fingerprint, or an entry lacks what `each` asks it for;
/// IoError if the file cannot be read.
void read_journal(const std::filesystem::path& path, std::string_view what,
                  const std::string& fingerprint, const std::function<void(const io::Json&)>& each);

/// Adds text at the end of a file; false where that failed.
bool append(const std::filesystem::path& path, const std::string& text);

}  // namespace repose::study
