// A recording: what was commanded and measured in some runs of an experiment, and the scene that claims to explain it.
// recording.yaml, schema 1; docs/guide/measurements.md says how to write one:
//
//   scene: scene.yaml
//   runs:
//     - {file: run_00.csv, role: fit}                 # or held_out; CSV whose column t is the time [s], or HDF5
//   inputs:
//     - {column: cmd, target: joint/shoulder/position, unit: rad}       # or /velocity, /torque
//     - {columns: [x, y, z], target: body/hand/position, unit: m}      # of a body of kind `moving`
//   channels:
//     - {column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}
//     - {columns: [x, y, z], kind: position, body: cube, unit: m, noise: unknown}
//     - {column: height, kind: position, body: ball, axis: [0, 0, 1], unit: m}
//     - {columns: [qx, qy, qz, qw], kind: orientation, body: cube}
//     - {columns: [mx, my, mz], kind: marker, body: beam, point: [0, 0, 0.1], unit: m}      # or vertex: 120
//     - {file: masks.h5, kind: mask, camera: wrist, part: gripper}      # beside each run's table; {run}: its name
//     - {file: video.h5, kind: video, camera: wrist, noise: unknown}  # or wrist.mp4, wrist_%06d.png with
//                                                                      # frames_per_second, first_frame [s]
//   initial: first_sample            # or fitted, or a mapping such as {joint/shoulder/position: 0.1}
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/formats/part_masks.hpp"
#include "host/formats/table.hpp"
#include "host/load/recording/channel_kinds.hpp"
#include "host/model/scene.hpp"

namespace pvg {

// Masks of one part in one camera's pictures of a run.
struct RecordedMasks {
  PartMasks masks;
  std::vector<int> frame_of_row;  // [n_rows of the table] which mask was seen at its time, -1: none
};

// The pictures of one camera in a run; the luminance of their cells is in the table.
struct RecordedVideo {
  int width = 0, height = 0;
  std::vector<int> frame_of_row;  // [n_rows of the table] which picture was taken at its time, -1: none
};

struct RecordedRun {
  std::string name;  // as the recording names the file
  bool is_held_out = false;
  MeasuredTable table;                // with a column per moment of masks and per cell of pictures
  std::vector<RecordedMasks> masks;   // [n_mask_sources]
  std::vector<RecordedVideo> videos;  // [n_video_sources]
};

// What was commanded: columns, and what of the scene they are fed to.
struct RecordedInput {
  std::vector<std::string> columns;
  std::string target, unit;  // joint/NAME/position, ...; empty unit: SI
};

struct RecordedChannel {
  ChannelKind kind = {};
  std::vector<std::string> columns;
  std::string joint, body, unit;
  std::optional<Vec3> point;  // of a marker, rest position in the body's frame [m]
  int vertex = -1;            // of a marker instead
  std::optional<Vec3> axis;   // of a position or marker with one column: its part along this direction
  double noise = -1;          // one sigma, in `unit`; negative: unknown
  int source = -1;            // of pictures: which of Recording::mask_sources or video_sources
  int part = -1;              // then: which moment (mask_metrics.hpp) or cell (picture_cells.hpp), a channel for each
};

// What a camera saw of a part.
struct MaskSource {
  std::string file, camera, part;
};

// What a camera saw.
struct VideoSource {
  std::string file, camera;
  double frames_per_second = 0;  // 0: the file holds its times, or has a picture per row
  double first_frame = 0;        // time of the first picture [s]
};
const char* kind_name(ChannelKind kind);

struct Recording {
  enum class Initial { first_sample, fitted, given };
  std::filesystem::path file, scene;
  std::vector<RecordedRun> runs;
  std::vector<RecordedInput> inputs;
  std::vector<RecordedChannel> channels;
  std::vector<MaskSource> mask_sources;
  std::vector<VideoSource> video_sources;
  Initial initial = Initial::first_sample;
  std::map<std::string, double> given;  // "joint/NAME/position", "joint/NAME/velocity" -> SI
};

// `path`: the folder or its recording.yaml. Throws a UsageError that names file, line and key.
Recording load_recording(const std::filesystem::path& path);

}  // namespace pvg
