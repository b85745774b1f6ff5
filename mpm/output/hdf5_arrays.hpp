#pragma once
/// \file
/// Arrays of numbers in HDF5 files that are written whole or not at all, and sealed.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
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
void write(hid_t file, const std::string& name, std::span<const T> values) {
  // of a size: a last one that is nearly empty would take as much room as a full one
  constexpr hsize_t most = 1 << 20;
  const hsize_t n = values.size(), chunks = (n + most - 1) / most,
                chunk = n > 0 ? (n + chunks - 1) / chunks : 0;
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
template <class T, class Allocator>
void write(hid_t file, const std::string& name, const std::vector<T, Allocator>& values) {
  write(file, name, std::span<const T>(values));
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
  /// bytes: about as many as it will hold. (Grown by small steps and copied to be sealed, the
  /// points of a checkpoint were three times in memory, besides those of the run.)
  explicit NewFile(std::size_t bytes)
      : access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a property list"),
        // HDF5 first tries to load a file of this name, so it is one that cannot exist
        file_((H5Pset_fapl_core(access_, std::max(bytes, std::size_t{1} << 20), false),
               H5Fcreate("/dev/null/arrays", H5F_ACC_TRUNC, H5P_DEFAULT, access_)),
              H5Fclose, "create a file in memory") {}
  operator hid_t() const { return file_; }

  /// Throws io::IoError.
  void save(const std::filesystem::path& path) const {
    H5Fflush(file_, H5F_SCOPE_GLOBAL);
    const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
    void* memory = nullptr;  // where the driver has the image: no copy
    if (size < 0 || H5Fget_vfd_handle(file_, H5P_DEFAULT, &memory) < 0)
      throw std::runtime_error("HDF5 could not give the file's bytes");
    const std::string_view content(*static_cast<const char* const*>(memory),
                                   static_cast<std::size_t>(size));
    io::write_atomically(path, {content, io::seal_of(content)});
  }

 private:
  Handle access_, file_;
};

/// One that was saved so.
class SealedFile {
 public:
  explicit SealedFile(const std::filesystem::path& path)
      : access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make a property list"),
        file_(opened(io::read_sealed(path)), H5Fclose, "open its arrays") {}
  operator hid_t() const { return file_; }

 private:
  hid_t opened(std::string image) {
    H5Pset_fapl_core(access_, 1, false);
    if (H5Pset_file_image(access_, image.data(), image.size()) < 0)
      throw std::runtime_error("HDF5 takes no image");
    image = {};  // that was a copy, and opening makes another
    return H5Fopen("arrays", H5F_ACC_RDONLY, access_);
  }
  Handle access_, file_;
};

}  // namespace repose::mpm::hdf5
