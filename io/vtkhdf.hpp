#pragma once

#include <string>

#include "io/frame_reader.hpp"
#include "io/frame_writer.hpp"

namespace repose::io {

/// The bytes of an HDF5 file that holds the frame as a VTKHDF 1.0 UnstructuredGrid of vertex cells.
/// Assembled in memory, so that the only thing that touches the disk is one plain write whose
/// failure the operating system explains (HDF5 on a full disk leaves a file it cannot close).
/// Peak memory: about twice the frame, 100 to 300 bytes per point.
/// Deterministic: no object times. Errors: std::invalid_argument as at FrameView;
/// std::runtime_error with HDF5's own reason (in practice: out of memory).
std::string vtkhdf_image(const FrameView& frame);

/// The same of a grid, as VTKHDF 1.0 ImageData.
std::string vtkhdf_image(const GridView& grid);

/// Reads the bytes of a frame of points back; read_frame() is the way to it.
/// Errors: std::runtime_error with HDF5's own reason, or that they are no VTKHDF file of points.
Frame read_vtkhdf(std::string& image);

}  // namespace repose::io
