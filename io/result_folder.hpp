#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.hpp"

namespace repose::io {

/// The folder that one run, test or fit leaves behind.
class ResultFolder {
 public:
  /// Opens the folder, creating it and its parents where they are missing.
  /// Errors: IoError, also for a path that is a file.
  explicit ResultFolder(std::filesystem::path folder);

  /// results/NAME: where a result goes when no -o is given.
  static std::filesystem::path default_path(std::string_view name);

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path file(std::string_view name) const { return folder_ / name; }
  std::filesystem::path frames() const { return folder_ / "frames"; }
  std::filesystem::path checkpoint() const { return folder_ / "checkpoint.h5"; }
  /// The one before it, in case that one is damaged.
  std::filesystem::path previous_checkpoint() const { return folder_ / "checkpoint_previous.h5"; }

  /// Clears what an older result left, so that it cannot be taken for part of a new one: the files
  /// of output_names(), frames (NAME_00012.hdf, NAME.hdf.series in frames/) and temporaries of
  /// killed runs. input.toml stays, since writing the new one replaces it. Anything else in the
  /// folder is somebody else's and is not touched. Not for a run that resumes. Errors: IoError.
  void remove_old_outputs() const;

  /// Removes only what killed processes left of files that were being written.
  void remove_old_parts() const;

  /// Removes both checkpoints, if they are there: of a result that is done.
  void remove_checkpoints() const;

  /// Declares the result complete: writes manifest.json with the length and the checksum of every
  /// file of it (of frames, which have their own, the length), and names the results in runs/,
  /// which have one of their own. Errors: IoError.
  void seal() const;

  /// What is not as seal() found it: "series.csv is not as it was written"; "there is no
  /// manifest.json" if it never did. "" for a result that is whole.
  std::string damage() const;

  /// The same of some files only; those that seal() did not find are damaged.
  std::string damage(std::span<const std::string> names) const;

  /// The names that repose may write into a result folder, input.toml and frames/ aside.
  static std::span<const std::string_view> output_names();

  /// Writes folder/name as a whole or not at all (write_atomically).
  void write_file(std::string_view name, std::string_view content,
                  Outlives outlives = Outlives::power_cut) const;

 private:
  std::filesystem::path folder_;
};

/// While one lives, this process alone writes into the folder, and another that tries is refused
/// with this one's number. It ends with the process, however that ends. (A lock on the hidden file
/// .repose-lock; where the file system has no locks, nothing is refused.)
class FolderClaim {
 public:
  /// Errors: IoError if another process, or another claim of this one, has it.
  explicit FolderClaim(const ResultFolder& folder);
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

 private:
  std::filesystem::path path_;
  int fd_ = -1;
};

/// A CSV table that grows row by row while a run goes on. Each row reaches the file as soon as it
/// is given, and after any failure the file holds complete rows only: a row that was cut short
/// (disk full) is taken back before IoError is thrown; the same row may then be given again.
class RowWriter {
 public:
  /// A new table with one header line; an older file of that name is overwritten.
  /// columns: names with units ("front_m"), at least one, without comma, quote or line break.
  /// Errors: IoError; std::invalid_argument for the names.
  static RowWriter create(std::filesystem::path path, std::vector<std::string> columns);

  /// Takes up a table after a restart: rows whose first column is at most `last` stay, what follows
  /// is cut off. A missing file is begun anew. Errors: as create; IoError if the file has another
  /// header.
  static RowWriter continued(std::filesystem::path path, std::vector<std::string> columns,
                             double last);

  RowWriter(RowWriter&& other) noexcept;
  RowWriter& operator=(RowWriter&&) = delete;
  ~RowWriter();

  /// Appends one row: as many values as columns, each in the fewest digits that read back as the
  /// same double; not-a-number appears as nan. Errors: IoError; std::invalid_argument for the
  /// count.
  void row(std::span<const double> values);
  /// Rows that are text already (text_of), all of them or none.
  void rows(std::string_view text) { append(text); }
  /// Rows as row() writes them, for a multiple of `columns` values.
  static std::string text_of(std::span<const double> values, std::size_t columns);

  const std::filesystem::path& path() const { return path_; }

 private:
  RowWriter(std::filesystem::path path, std::size_t columns, int fd);
  void append(std::string_view line);

  std::filesystem::path path_;
  std::size_t columns_;
  int fd_;
};

}  // namespace repose::io
