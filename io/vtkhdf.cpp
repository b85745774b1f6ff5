#include "io/vtkhdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string_view>

#include <hdf5.h>

#include "io/hdf5_lock.hpp"

namespace repose::io {

namespace {

// VTK's cell type of a single point (vtkCellType.h: VTK_VERTEX).
constexpr std::uint8_t vtk_vertex = 1;

/// Keeps HDF5 from printing its error stack while it is in scope; errors become exceptions here.
class SilentErrors {
 public:
  SilentErrors() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;
  ~SilentErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  Hdf5Lock alone_;  // HDF5 has one thread at a time
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// The innermost message of HDF5's error stack: the cause, not the call chain.
std::string hdf5_reason() {
  std::string reason;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* error, void* out) -> herr_t {
        if (depth == 0 && error->desc) *static_cast<std::string*>(out) = error->desc;
        return 0;
      },
      &reason);
  return reason.empty() ? "unknown HDF5 error" : reason;
}

[[noreturn]] void fail(std::string_view doing) {
  throw std::runtime_error("HDF5 could not " + std::string(doing) + ": " + hdf5_reason());
}

void check(herr_t status, std::string_view doing) {
  if (status < 0) fail(doing);
}

/// An HDF5 identifier, closed by the function that belongs to its kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close, std::string_view doing) : id_(id), close_(close) {
    if (id < 0) fail(doing);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

template <typename T>
hid_t type_of() {
  if constexpr (std::is_same_v<T, double>) {
    return H5T_NATIVE_DOUBLE;
  } else if constexpr (std::is_same_v<T, std::int64_t>) {
    return H5T_NATIVE_INT64;
  } else if constexpr (std::is_same_v<T, std::int32_t>) {
    return H5T_NATIVE_INT32;
  } else {
    static_assert(std::is_same_v<T, std::uint8_t>);
    return H5T_NATIVE_UINT8;
  }
}

/// A dataset of the given extents, the last one fastest; their product is values.size().
template <typename T>
void write_shaped(hid_t group, const std::string& name, std::span<const T> values,
                  std::span<const hsize_t> extents) {
  const Handle space(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                     H5Sclose, "describe " + name);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "describe " + name);
  check(H5Pset_obj_track_times(properties, false), "describe " + name);
  const Handle set(
      H5Dcreate2(group, name.c_str(), type_of<T>(), space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose, "create " + name);
  check(H5Dwrite(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write " + name);
}

/// A dataset of rows × components values, row by row; components 1 makes it one-dimensional.
template <typename T>
void write_dataset(hid_t group, const std::string& name, std::span<const T> values,
                   std::size_t components = 1) {
  const std::array<hsize_t, 2> size{values.size() / components, components};
  write_shaped<T>(group, name, values, std::span(size).first(components == 1 ? 1 : 2));
}

Handle create_group(hid_t parent, const char* name) {
  const Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "describe a group");
  check(H5Pset_obj_track_times(properties, false), "describe a group");
  return {H5Gcreate2(parent, name, H5P_DEFAULT, properties, H5P_DEFAULT), H5Gclose,
          std::string("create group ") + name};
}

template <typename T>
void write_attribute(hid_t object, const char* name, std::span<const T> values) {
  const hsize_t count = values.size();
  const Handle list(H5Screate_simple(1, &count, nullptr), H5Sclose,
                    std::string("describe ") + name);
  const Handle set(H5Acreate2(object, name, type_of<T>(), list, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                   std::string("create ") + name);
  check(H5Awrite(set, type_of<T>(), values.data()), std::string("write ") + name);
}

/// The two attributes by which VTK knows the layout. The type must be a fixed-length ASCII string.
void write_layout(hid_t root, std::string_view kind) {
  const std::array<std::int64_t, 2> version{1, 0};
  write_attribute<std::int64_t>(root, "Version", version);

  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose, "describe Type");
  const Handle text(H5Tcopy(H5T_C_S1), H5Tclose, "describe Type");
  check(H5Tset_size(text, kind.size()), "describe Type");
  check(H5Tset_strpad(text, H5T_STR_NULLPAD), "describe Type");
  const Handle type(H5Acreate2(root, "Type", text, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                    "create Type");
  check(H5Awrite(type, text, kind.data()), "write Type");
}

/// Columns side by side, row by row; an empty column stands for zeros.
std::vector<double> interleave(std::size_t rows, std::span<const std::span<const double>> columns) {
  std::vector<double> table(rows * columns.size(), 0.0);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < columns[c].size(); ++i)
      table[i * columns.size() + c] = columns[c][i];
  return table;
}

void write_columns(hid_t group, const std::string& name, std::size_t rows,
                   std::initializer_list<std::span<const double>> columns) {
  const std::vector<double> table =
      interleave(rows, std::span<const std::span<const double>>(columns.begin(), columns.size()));
  write_dataset<double>(group, name, table, columns.size());
}

/// One vertex cell per point: cell i is made of point i alone.
void write_cells(hid_t root, std::size_t n) {
  std::vector<std::int64_t> count_up(n + 1);
  std::iota(count_up.begin(), count_up.end(), std::int64_t{0});
  const std::span<const std::int64_t> offsets(count_up);
  // VTKHDF allows several partitions; ours is one, hence the one-element counts.
  const std::array<std::int64_t, 1> count{static_cast<std::int64_t>(n)};
  write_dataset<std::int64_t>(root, "NumberOfPoints", count);
  write_dataset<std::int64_t>(root, "NumberOfCells", count);
  write_dataset<std::int64_t>(root, "NumberOfConnectivityIds", count);
  write_dataset<std::int64_t>(root, "Connectivity", offsets.first(n));
  write_dataset<std::int64_t>(root, "Offsets", offsets);
  write_dataset<std::uint8_t>(root, "Types", std::vector<std::uint8_t>(n, vtk_vertex));
}

void write_fields(hid_t group, const FrameView& frame) {
  const std::size_t n = frame.x_m.size();
  for (const auto& field : frame.scalars) write_dataset<double>(group, field.name, field.values);
  for (const auto& field : frame.vectors)
    write_columns(group, field.name, n, {field.x, field.y, field.z});
  for (const auto& field : frame.tensors)
    write_columns(group, field.name, n,
                  {field.xx, field.yy, field.zz, field.xy, field.yz, field.zx});
  for (const auto& field : frame.integers)
    write_dataset<std::int32_t>(group, field.name, field.values);
}

/// Collects the rules of FrameView, so that every kind of field is held to the same ones.
class Rules {
 public:
  Rules(std::size_t points, std::string_view what) : points_(points), what_(what) {}

  void check_name(const std::string& name) {
    const bool unfit = std::any_of(name.begin(), name.end(), [](char c) {
      return c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    });
    if (name.empty() || name == "." || unfit)
      throw std::invalid_argument("frame: '" + name + "' cannot be the name of a field");
    if (!names_.insert(name).second)
      throw std::invalid_argument("frame: two fields are called '" + name + "'");
  }
  void check_size(const std::string& name, std::size_t size) const {
    if (size != points_)
      throw std::invalid_argument("frame: " + name + " has " + std::to_string(size) +
                                  " values for " + std::to_string(points_) + " " +
                                  std::string(what_));
  }
  /// Of what stands for zeros where it is empty.
  void check_size_if_any(const std::string& name, std::size_t size) const {
    if (size != 0) check_size(name, size);
  }

 private:
  std::size_t points_;
  std::string_view what_;  ///< that there are so many of
  std::set<std::string> names_;
};

void check_time(double time_s) {
  if (!std::isfinite(time_s))
    throw std::invalid_argument("frame: its time is " + std::to_string(time_s) + " s");
}

/// Of what frames of points and of grids have alike.
template <class View>
void check_scalars_and_vectors(const View& frame, Rules& rules) {
  for (const auto& field : frame.scalars) {
    rules.check_name(field.name);
    rules.check_size(field.name, field.values.size());
  }
  for (const auto& field : frame.vectors) {
    rules.check_name(field.name);
    for (const auto& part : {field.x, field.y}) rules.check_size(field.name, part.size());
    rules.check_size_if_any(field.name, field.z.size());
  }
}

void check_view(const FrameView& frame) {
  if (frame.x_m.empty()) throw std::invalid_argument("frame: it has no points");
  check_time(frame.time_s);
  Rules rules(frame.x_m.size(), "points");
  rules.check_size("y_m", frame.y_m.size());
  rules.check_size_if_any("z_m", frame.z_m.size());
  check_scalars_and_vectors(frame, rules);
  for (const auto& field : frame.tensors) {
    rules.check_name(field.name);
    for (const auto& part : {field.xx, field.yy, field.zz, field.xy})
      rules.check_size(field.name, part.size());
    for (const auto& part : {field.yz, field.zx}) rules.check_size_if_any(field.name, part.size());
  }
  for (const auto& field : frame.integers) {
    rules.check_name(field.name);
    rules.check_size(field.name, field.values.size());
  }
}

std::size_t count_of(const GridView& grid) { return grid.nodes[0] * grid.nodes[1] * grid.nodes[2]; }

void check_view(const GridView& grid) {
  if (count_of(grid) == 0) throw std::invalid_argument("frame: its grid has no nodes");
  if (!(grid.h_m > 0.0) || !std::isfinite(grid.h_m))
    throw std::invalid_argument("frame: its cells are " + std::to_string(grid.h_m) + " m wide");
  check_time(grid.time_s);
  Rules rules(count_of(grid), "nodes");
  check_scalars_and_vectors(grid, rules);
}

/// A file that lives in memory only (HDF5's core driver without a backing store).
Handle create_in_memory(hid_t access) {
  constexpr std::size_t growth = std::size_t{1} << 20;
  check(H5Pset_fapl_core(access, growth, false), "set up memory");
  // HDF5 first tries to load a file of this name, so it is one that cannot exist.
  return {H5Fcreate("/dev/null/frame", H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose,
          "create the frame"};
}

std::string image_of(hid_t file) {
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "finish the frame");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) fail("measure the frame");
  std::string image(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, image.data(), image.size()) < 0) fail("copy the frame");
  return image;
}

/// Every component of a dataset as doubles, row by row; no values if it holds no numbers.
struct Numbers {
  std::size_t rows = 0, components = 1;
  std::vector<double> values;
};

Numbers read_numbers(hid_t group, const std::string& name) {
  const Handle set(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "find " + name);
  const Handle type(H5Dget_type(set), H5Tclose, "read the type of " + name);
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) return {};
  const Handle space(H5Dget_space(set), H5Sclose, "read the shape of " + name);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 1 || rank > 2) return {};
  std::array<hsize_t, 2> size{0, 1};
  check(H5Sget_simple_extent_dims(space, size.data(), nullptr), "read the shape of " + name);
  constexpr hsize_t most = hsize_t{1} << 32;  // what no frame has room for
  if (size[0] > most || size[1] > most || size[0] * size[1] > most)
    throw std::runtime_error(name + " claims more values than a frame can hold");
  Numbers numbers{size[0], size[1], std::vector<double>(size[0] * size[1])};
  check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.values.data()),
        "read " + name);
  return numbers;
}

std::vector<std::string> names_in(hid_t group) {
  H5G_info_t info{};
  check(H5Gget_info(group, &info), "list the fields");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto name = [&](char* text, std::size_t size) {
      const ssize_t length =
          H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
      if (length < 0) fail("list the fields");
      return static_cast<std::size_t>(length);
    };
    std::string text(name(nullptr, 0), '\0');
    name(text.data(), text.size() + 1);
    names.push_back(std::move(text));
  }
  return names;
}

}  // namespace

Frame read_vtkhdf(std::string& image) {
  const SilentErrors silent;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "set up memory");
  check(H5Pset_fapl_core(access, 1, false), "set up memory");
  check(H5Pset_file_image(access, image.data(), image.size()), "take its bytes");
  const Handle file(H5Fopen("frame", H5F_ACC_RDONLY, access), H5Fclose, "open it");
  const Handle root(H5Gopen2(file, "VTKHDF", H5P_DEFAULT), H5Gclose, "find VTKHDF");
  Frame frame;
  const Numbers points = read_numbers(root, "Points");
  if (points.components != 3) throw std::runtime_error("its Points are not rows of x, y and z");
  frame.points = points.rows;
  frame.position_m = points.values;
  const Handle fields(H5Gopen2(root, "PointData", H5P_DEFAULT), H5Gclose, "find PointData");
  for (const std::string& name : names_in(fields)) {
    Numbers numbers = read_numbers(fields, name);
    if (numbers.values.empty()) continue;
    if (numbers.rows != frame.points)
      throw std::runtime_error("its field " + name + " has " + std::to_string(numbers.rows) +
                               " values for " + std::to_string(frame.points) + " points");
    frame.fields.push_back({name, numbers.components, std::move(numbers.values)});
  }
  const Handle whole(H5Gopen2(root, "FieldData", H5P_DEFAULT), H5Gclose, "find FieldData");
  const Numbers time = read_numbers(whole, "TimeValue");
  if (time.values.size() != 1) throw std::runtime_error("it has no single TimeValue");
  frame.time_s = time.values.front();
  return frame;
}

namespace {

/// A file of one frame; `write` is given its group VTKHDF.
template <class F>
std::string image_with(F&& write) {
  const SilentErrors silent;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "set up memory");
  const Handle file = create_in_memory(access);
  {
    const Handle root = create_group(file, "VTKHDF");
    write(root);
  }
  return image_of(file);
}

}  // namespace

std::string vtkhdf_image(const FrameView& frame) {
  check_view(frame);
  return image_with([&](hid_t root) {
    write_layout(root, "UnstructuredGrid");
    write_columns(root, "Points", frame.x_m.size(), {frame.x_m, frame.y_m, frame.z_m});
    write_cells(root, frame.x_m.size());
    const Handle fields = create_group(root, "PointData");
    write_fields(fields, frame);
    // ParaView shows it as the data's time even for a frame opened by itself.
    const Handle whole = create_group(root, "FieldData");
    write_dataset<double>(whole, "TimeValue", std::span<const double>(&frame.time_s, 1));
  });
}

std::string vtkhdf_image(const GridView& grid) {
  check_view(grid);
  return image_with([&](hid_t root) {
    write_layout(root, "ImageData");
    const auto last = [&](std::size_t axis) {
      return static_cast<std::int64_t>(grid.nodes[axis]) - 1;
    };
    // ParaView 5.11 writes beyond its own arrays where y or z has one layer of nodes. So in the
    // plane the axes of the image are z, x and y, which its directions say.
    const bool plane = grid.nodes[2] == 1;
    write_attribute<std::int64_t>(
        root, "WholeExtent",
        plane ? std::array<std::int64_t, 6>{0, 0, 0, last(0), 0, last(1)}
              : std::array<std::int64_t, 6>{0, last(0), 0, last(1), 0, last(2)});
    write_attribute<double>(root, "Origin", std::array<double, 3>{});
    write_attribute<double>(root, "Spacing", std::array{grid.h_m, grid.h_m, grid.h_m});
    write_attribute<double>(root, "Direction",
                            plane ? std::array<double, 9>{0, 1, 0, 0, 0, 1, 1, 0, 0}
                                  : std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
    const Handle fields = create_group(root, "PointData");
    std::vector<hsize_t> extents{grid.nodes[2], grid.nodes[1], grid.nodes[0]};
    if (plane) extents = {grid.nodes[1], grid.nodes[0], 1};
    for (const auto& field : grid.scalars)
      write_shaped<double>(fields, field.name, field.values, extents);
    extents.push_back(3);
    for (const auto& field : grid.vectors) {
      const std::array columns{field.x, field.y, field.z};
      write_shaped<double>(fields, field.name, interleave(count_of(grid), columns), extents);
    }
    // no TimeValue: ParaView 5.11 takes every dataset of an image for one of nodes; the series has
    // it
  });
}

}  // namespace repose::io
