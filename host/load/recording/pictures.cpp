// The pictures of a run: masks and videos beside its table, as numbers in columns of it.
#include <algorithm>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/formats/picture_series.hpp"
#include "host/load/recording/channels.hpp"
#include "host/pictures/mask_metrics.hpp"
#include "host/pictures/picture_cells.hpp"

namespace pvg {
namespace {

constexpr double SAME_TIME = 1e-4;  // of a picture and a row [s]

// which of n pictures was seen in which row of the table: by their times, or one after the other; what: they are
std::vector<int> frames_of_rows(const std::vector<double>& time, std::size_t n, const std::vector<double>& t,
                                const std::string& file, const std::string& what) {
  std::vector<int> frame_of_row(t.size(), -1);
  if (time.empty()) {
    if (n != t.size())
      throw UsageError(file + " holds " + std::to_string(n) + " " + what + "s and no /time, its run " +
                       counted(t.size(), "row") + "; give one " + what + " per row, or /time [s]" +
                       (what == "picture" ? ", or `frames_per_second`" : ""));
    for (std::size_t i = 0; i < t.size(); ++i) frame_of_row[i] = int(i);
    return frame_of_row;
  }
  for (std::size_t frame = 0; frame < time.size(); ++frame) {
    const auto row = std::lower_bound(t.begin(), t.end(), time[frame] - SAME_TIME);
    if (row == t.end() || *row > time[frame] + SAME_TIME) continue;
    frame_of_row[std::size_t(row - t.begin())] = int(frame);
  }
  if (std::all_of(frame_of_row.begin(), frame_of_row.end(), [](int frame) { return frame < 0; }))
    throw UsageError(file + ": no " + what + " has the time of a row of its run; column t and /time must agree");
  return frame_of_row;
}

void add_masks(const MaskSource& source, RecordedRun& run) {
  const std::filesystem::path file = beside_table(run, source.file);
  RecordedMasks recorded{read_part_masks(file, source.part), {}};
  recorded.frame_of_row =
      frames_of_rows(recorded.masks.time, recorded.masks.pixels.size(), run.table["t"], file.string(), "mask");
  std::vector<std::vector<double>> columns(N_MASK_MOMENTS, std::vector<double>(run.table.n_rows, std::nan("")));
  for (std::size_t row = 0; row < recorded.frame_of_row.size(); ++row) {
    if (recorded.frame_of_row[row] < 0) continue;
    const auto moments = mask_moments(recorded.masks.pixels[std::size_t(recorded.frame_of_row[row])],
                                      recorded.masks.width, recorded.masks.height);
    for (std::size_t k = 0; k < N_MASK_MOMENTS; ++k) columns[k][row] = moments[k];
  }
  for (std::size_t k = 0; k < N_MASK_MOMENTS; ++k) run.table.columns[column_of(source, k)] = std::move(columns[k]);
  run.masks.push_back(std::move(recorded));
}

void add_video(const VideoSource& source, RecordedRun& run) {
  const std::filesystem::path file = beside_table(run, source.file);
  PictureSeries series = read_picture_series(file);
  if (source.frames_per_second > 0) {
    if (!series.time.empty())
      throw UsageError(file.string() + " has /time of its own; leave `frames_per_second` away, or /time");
    for (std::size_t frame = 0; frame < series.cells.size(); ++frame)
      series.time.push_back(source.first_frame + double(frame) / source.frames_per_second);
  }
  RecordedVideo recorded{series.width, series.height, {}};
  recorded.frame_of_row = frames_of_rows(series.time, series.cells.size(), run.table["t"], file.string(), "picture");
  for (std::size_t cell = 0; cell < N_PICTURE_CELLS; ++cell) {
    std::vector<double> column(run.table.n_rows, std::nan(""));
    for (std::size_t row = 0; row < column.size(); ++row)
      if (recorded.frame_of_row[row] >= 0) column[row] = series.cells[std::size_t(recorded.frame_of_row[row])][cell];
    run.table.columns[column_of(source, cell)] = std::move(column);
  }
  run.videos.push_back(std::move(recorded));
}

}  // namespace

std::string column_of(const MaskSource& masks, std::size_t moment) {
  return "mask of " + masks.part + " by " + masks.camera + ", " + MASK_MOMENT_NAMES[moment];
}

std::string column_of(const VideoSource& video, std::size_t cell) {
  return "video of " + video.camera + ", " + cell_name(cell);
}

void add_pictures(const Recording& recording, RecordedRun& run) {
  for (const MaskSource& source : recording.mask_sources) add_masks(source, run);
  for (const VideoSource& source : recording.video_sources) add_video(source, run);
}

}  // namespace pvg
