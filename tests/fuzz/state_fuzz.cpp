// What a run reads back of its own: checkpoints, frames and the series that names them. The first
// byte chooses:
//   0..2  the bytes that follow stand in for the file (checkpoint, frame, series): a file that is
//   not
//         the one that was written is refused with a reason;
//   3     the bytes that follow are changes of a checkpoint's arrays (and its seal is made anew, as
//   a
//         program with a fault would): it is refused, or the run goes on with finite numbers or
//         ends with a reason.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include "io/atomic_file.hpp"
#include "io/frame_reader.hpp"
#include "io/frame_writer.hpp"
#include "io/seal.hpp"
#include "mpm/grid/numerical_failure.hpp"
#include "mpm/step/simulation.hpp"

namespace {

using namespace repose;
namespace fs = std::filesystem;

[[noreturn]] void finding(std::string_view what, std::string_view text) {
  std::fprintf(stderr, "FINDING: %.*s: %.*s\n", static_cast<int>(what.size()), what.data(),
               static_cast<int>(text.size()), text.data());
  std::abort();
}

mpm::Scene small_scene() {
  mpm::Scene scene;
  scene.name = "fuzz";
  scene.end_time = 1.0;
  scene.domain = {0.2, 0.2, 0.0};
  scene.h = 0.025;
  mpm::Body body;
  body.size = {0.1, 0.1, 0.0};
  body.law = {"modified_cam_clay",
              {{"compression", "ln_v-ln_p"}},
              {{"M", 0.66},
               {"lambda", 0.0186},
               {"kappa", 0.001},
               {"nu", 0.3},
               {"Gamma", 1.543},
               {"p_ref", 1.0},
               {"rho_p", 2000.0}}};
  body.initial.p = 50.0;
  body.initial.ocr = 1.0;
  scene.bodies.push_back(body);
  return scene;
}

/// The arrays of a checkpoint by name, all as doubles.
using Arrays = std::map<std::string, std::vector<double>>;
bool is_whole(const std::string& name) {
  return name == "wholes" || name == "blocks" || name.ends_with("_id");
}

struct Written {
  fs::path folder;
  mpm::Simulation simulation{small_scene(), 1};
  std::string checkpoint, frame, series;
  Arrays arrays;

  Written() {
    const fs::path base = fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    folder = base / ("repose_state_fuzz_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    while (simulation.steps() < 40) simulation.step(HUGE_VAL);
    simulation.save(folder / "c.h5");
    checkpoint = io::read_bytes(folder / "c.h5");
    io::FrameWriter frames(folder / "frames", "f");
    const mpm::Simulation::Snapshot shot = simulation.snapshot();
    frame = io::read_bytes(frames.write(shot.view(simulation.time())));
    series = io::read_bytes(frames.series_path());
    std::string image = io::read_sealed(folder / "c.h5");
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_core(access, 1, false);
    H5Pset_file_image(access, image.data(), image.size());
    const hid_t file = H5Fopen("c", H5F_ACC_RDONLY, access);
    H5G_info_t info{};
    H5Gget_info(file, &info);
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      char name[64] = {};
      H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
      const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
      const hid_t space = H5Dget_space(set);
      std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
      if (!values.empty())
        H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      arrays[name] = values;
      H5Sclose(space);
      H5Dclose(set);
    }
    H5Fclose(file);
    H5Pclose(access);
  }
  ~Written() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

Written& written() {
  static Written written;
  return written;
}

void put(const fs::path& file, std::string_view bytes) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0 || ::write(fd, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
    finding("cannot write", file.string());
  ::close(fd);
}

std::string file_of(const Arrays& arrays) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 16, false);
  const hid_t file = H5Fcreate("/dev/null/c", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  for (const auto& [name, values] : arrays) {
    const hsize_t n = values.size();
    const hid_t space = H5Screate_simple(1, &n, nullptr);
    const hid_t set =
        H5Dcreate2(file, name.c_str(), is_whole(name) ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE, space,
                   H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (n > 0) {
      if (is_whole(name)) {
        std::vector<std::int64_t> wholes;
        for (const double x : values)
          wholes.push_back(x > -9e18 && x < 9e18 ? static_cast<std::int64_t>(x) : 0);
        H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, wholes.data());
      } else {
        H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      }
    }
    H5Dclose(set);
    H5Sclose(space);
  }
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  std::string image(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)), '\0');
  H5Fget_file_image(file, image.data(), image.size());
  H5Fclose(file);
  H5Pclose(access);
  return image + io::seal_of(image);
}

/// Changes of 11 bytes: which array, what, where (2), and a number (8) or a length.
Arrays changed(Arrays arrays, const std::uint8_t* data, std::size_t size) {
  for (; size >= 12 && !arrays.empty(); data += 12, size -= 12) {
    auto it = arrays.begin();
    std::advance(it, data[0] % arrays.size());
    std::vector<double>& values = it->second;
    const std::size_t where = data[2] + 256U * data[3];
    double number = 0.0;
    std::memcpy(&number, data + 4, sizeof number);
    switch (data[1] % 6) {
      case 0:
        arrays.erase(it);
        break;
      case 1:
        values.resize(where % (values.size() + 40));
        break;
      case 2:  // a small whole number
        if (!values.empty()) values[where % values.size()] = static_cast<double>(data[4]) - 4.0;
        break;
      case 3:
        if (!values.empty()) values[where % values.size()] += static_cast<double>(data[4]) - 128.0;
        break;
      case 4:
        if (!values.empty()) values[where % values.size()] *= -1.0;
        break;
      default:
        if (!values.empty()) values[where % values.size()] = number;
    }
  }
  return arrays;
}

template <class Read>
bool refused(const Read& read) {
  try {
    read();
    return false;
  } catch (const io::IoError& error) {
    const std::string why = error.what();
    for (const std::string_view word : {"vector::", "basic_string", "std::", "stod", "[json"})
      if (why.find(word) != std::string::npos) finding("a library speaks", why);
    if (why.size() < error.path().string().size() + 10) finding("no reason", why);
    return true;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  Written& w = written();
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const fs::path file = w.folder / "x";
  switch (data[0] % 4) {
    case 0:
      put(file, bytes);
      if (!refused([&] { w.simulation.load(file); }) && bytes != w.checkpoint)
        finding("a checkpoint that nobody wrote was taken", "");
      break;
    case 1:
      put(file, bytes);
      if (!refused([&] { io::read_frame(file); }) && bytes != w.frame)
        finding("a frame that nobody wrote was taken", "");
      break;
    case 2:
      put(file, bytes);
      refused([&] {
        for (const io::FrameEntry& entry : io::read_frame_series(file))
          if (entry.file_name.find('/') != std::string::npos) finding("a way out", entry.file_name);
      });
      break;
    default:
      put(file, file_of(changed(w.arrays, data + 1, size - 1)));
      if (refused([&] { w.simulation.load(file); })) break;
      try {
        for (int k = 0; k < 2; ++k) w.simulation.step(HUGE_VAL);
      } catch (const mpm::NumericalFailure&) {
        // said so
      }
  }
  return 0;
}
