// The pictures of a video, each as the luminance of its cells: from an HDF5 file with
//   /rgb  [F, H, W, 3]  u8, sRGB
//   /time [F, s]        if it is there
// from picture files that are numbered without a gap from 0 or 1 on (wrist_%06d.png), or from a video file that ffmpeg
// reads (wrist.mp4).
#pragma once
#include <filesystem>
#include <vector>

#include "host/pictures/picture_cells.hpp"

namespace pvg {

struct PictureSeries {
  int width = 0, height = 0;
  std::vector<double> time;         // [n_frames, s], empty: the file has none
  std::vector<PictureCells> cells;  // [n_frames]
};

// Throws a UsageError that names the file where it is not there, or its pictures are not such.
PictureSeries read_picture_series(const std::filesystem::path& file);

}  // namespace pvg
