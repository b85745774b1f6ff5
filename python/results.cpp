/// Frames and maps of result folders.
#include "binding.hpp"
#include "io/frame_reader.hpp"
#include "io/raster_file.hpp"
#include "io/table_error.hpp"

namespace repose::python {

void bind_results(py::module_& module) {
  module.def(
      "read_frame_series",
      [](const std::string& series) {
        std::vector<std::pair<std::string, double>> frames;
        for (const io::FrameEntry& entry : io::read_frame_series(series))
          frames.emplace_back(entry.file_name, entry.time_s);
        return frames;
      },
      py::arg("series"), "(file, time) of every frame that a NAME.hdf.series lists.");
  module.def(
      "point_series_in",
      [](const std::string& folder) { return io::point_series_in(folder).string(); },
      py::arg("folder"), "The NAME.hdf.series of a folder that is of points, or \"\".");
  module.def(
      "read_frame",
      [](const std::string& path) {
        io::Frame frame = [&] {
          const py::gil_scoped_release released;
          return io::read_frame(path);
        }();
        const auto n = static_cast<py::ssize_t>(frame.points);
        py::dict all;
        all["time_s"] = frame.time_s;
        all["position_m"] = array_of(std::move(frame.position_m), {n, 3});
        for (io::Frame::Field& field : frame.fields) {
          const auto components = static_cast<py::ssize_t>(field.components);
          const py::str name(field.name);
          if (components == 1)
            all[name] = array_of(std::move(field.values));
          else
            all[name] = array_of(std::move(field.values), {n, components});
        }
        return all;
      },
      py::arg("path"), "A frame: time_s, position_m and its fields, by name.");
  module.def(
      "read_raster",
      [](const std::string& path) {
        try {
          const io::RasterFile file = [&] {
            const py::gil_scoped_release released;
            return io::read_raster(path);
          }();
          return raster_of(file.raster, file.crs);
        } catch (const io::TableError& error) {
          throw input::BadInput({error.what()});
        }
      },
      py::arg("path"), "A map: values, west, south, cell, crs.");
}

}  // namespace repose::python
