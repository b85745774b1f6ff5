#pragma once
/// \file
/// Arrays of numbers in HDF5 files that are written whole or not at all, and sealed.

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <hdf5.h>

#include "io/atomic_file.hpp"
#include "io/hdf5_lock.hpp"
#include "io/seal.hpp"

namespace repose::mpm::hdf5 {

/// An open HDF5 object, closed by its own function.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const char* what) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error(fmt::format("HDF5 could not {}", what));
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <class T>
hid_t type_of();
template <>
inline hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t type_of<std::int64_t>() {
  return H5T_NATIVE_INT64;
}

/// With a checksum in every chunk (Fletcher's), which reading compares.
template <class T>
void write(hid_t file, const std::string& name, const std::vector<T>& values) {
  const hsize_t n = values.size(), chunk = std::min<hsize_t>(n, 1 << 20);
  const Handle space(H5Screate_simple(1, &n, nullptr), H5Sclose, "make a data space");
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a property list");
  if (n > 0 && (H5Pset_chunk(layout, 1, &chunk) < 0 || H5Pset_fletcher32(layout) < 0))
    throw std::runtime_error("HDF5 has no checksums");
  const Handle set(
      H5Dcreate2(file, name.c_str(), type_of<T>(), space, H5P_DEFAULT, layout, H5P_DEFAULT),
      H5Dclose, "create a data set");
  if (n > 0 && H5Dwrite(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw std::runtime_error(fmt::format("HDF5 could not write {}", name));
}

template <class T>
std::vector<T> read(hid_t file, const std::string& name) {
  const Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, ("find " + name).c_str());
  const Handle space(H5Dget_space(set), H5Sclose, "read a data space");
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count < 0) throw std::runtime_error(fmt::format("HDF5 could not read {}", name));
  std::vector<T> values(static_cast<std::size_t>(count));
  if (!values.empty() &&
      H5Dread(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw std::runtime_error(fmt::format("HDF5 could not read {}", name));
  return values;
}

/// Turns HDF5's own error printing off for a while, in which no other thread calls it.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  io::Hdf5Lock alone_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// A file that is assembled in memory, so that the disk sees one plain write.
class NewFile {
 public:
  NewFile()
      : access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a property list"),
        file_((H5Pset_fapl_core(access_, 1 << 20, false),
               H5Fcreate("arrays", H5F_ACC_TRUNC, H5P_DEFAULT, access_)),
              H5Fclose, "create a file in memory") {}
  operator hid_t() const { return file_; }

  /// Throws io::IoError.
  void save(const std::filesystem::path& path) const {
    H5Fflush(file_, H5F_SCOPE_GLOBAL);
    const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
    if (size < 0) throw std::runtime_error("HDF5 could not give the file's size");
    std::string image(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file_, image.data(), image.size()) < 0)
      throw std::runtime_error("HDF5 could not give the file's bytes");
    io::write_atomically(path, io::sealed(std::move(image)));
  }

 private:
  Handle access_, file_;
};

/// One that was saved so.
class SealedFile {
 public:
  explicit SealedFile(const std::filesystem::path& path)
      : image_(io::read_sealed(path)),
        access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a property list"),
        file_(opened(), H5Fclose, "open its arrays") {}
  operator hid_t() const { return file_; }

 private:
  hid_t opened() {
    H5Pset_fapl_core(access_, 1, false);
    if (H5Pset_file_image(access_, image_.data(), image_.size()) < 0)
      throw std::runtime_error("HDF5 takes no image");
    return H5Fopen("arrays", H5F_ACC_RDONLY, access_);
  }
  std::string image_;
  Handle access_, file_;
};

}  // namespace repose::mpm::hdf5
