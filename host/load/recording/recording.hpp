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
//     - {file: "{run}_encoder.csv", column: q, kind: position, joint: shoulder}   # a table of its own, at its own
//     rate;
//                                                    # `time: stamp` names its column of times, else `t`
//   initial: first_sample            # or fitted, or a mapping such as {joint/shoulder/position: 0.1}
//   priors: {body/tip/mass: {value: 0.37 kg, sigma: 0.01 kg}}
// Of any channel of a table also `latency: 20 ms`, `jitter: 0.05 ms`, `clock: {offset: 0.1 s, rate: 1.0001}`, `filter:
// {low_pass: 20 Hz}`, `resolution` and `saturation: [low, high]` in the channel's unit. A run may state what is its
// own:
//     - {file: run_01.csv, role: fit, set: {body/tip/mass: 52 g}, initial: {joint/hinge/velocity: {value: 0, sigma:
//     0.01}}}
//     - {file: run_02.csv, role: fit, disturbances: [{body: tip, force: [2 N, 0, 0], from: 0.3 s, to: 0.4 s}]}
//                                                     # or {body: tip, kind: force, columns: [fx, fy, fz], unit: N}
#pragma once
#include <cmath>
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

// A number that a recording states, as it is written: with its unit, and how well it is known.
struct StatedNumber {
  std::vector<std::string> value;  // one text, or one per component
  std::string sigma;               // one standard deviation; empty: it is exact, or nothing is said
};
using StatedNumbers = std::map<std::string, StatedNumber>;  // by what is meant, such as body/tip/mass

// A force or torque on a rigid body that is known, world frame: constant for a while, or columns of the run's table.
struct RecordedDisturbance {
  std::string body;
  Vec3 point = Vec3::Zero();  // where the force acts, in the body's frame [m]
  bool is_torque = false;
  Vec3 value = Vec3::Zero();  // [N] or [N m], from one time of the run's clock to another [s]
  double from = 0, to = 0;
  std::vector<std::string> columns;  // instead of value and times: x, y, z
  std::string unit;                  // of the columns; empty: SI
};

struct RecordedRun {
  std::string name;  // as the recording names the file
  bool is_held_out = false;
  MeasuredTable table;                // with a column per moment of masks, per cell of pictures, and of channels that
                                      // have a clock of their own; a row for each time of any of them
  std::vector<RecordedMasks> masks;   // [n_mask_sources]
  std::vector<RecordedVideo> videos;  // [n_video_sources]
  StatedNumbers set;                  // what the scene has otherwise in this run: body/tip/mass, gravity, ..
  StatedNumbers initial;              // what is known of its start: joint/hinge/velocity, body/cube/position, ..
  std::vector<RecordedDisturbance> disturbances;
};

// What was commanded: columns, and what of the scene they are fed to.
struct RecordedInput {
  std::vector<std::string> columns;
  std::string target, unit;  // joint/NAME/position, ...; empty unit: SI
};

// Where a channel was written, if not in the run's table at the times of its rows.
struct ChannelClock {
  std::string file;  // beside the run's table, {run} is its name without ending; empty: the run's table
  std::string time;  // the column of times [s]; empty: `t`
  // The sample that is stamped s shows what was there at (1 + rate) s + offset - latency of the run's clock.
  double latency = 0, offset = 0, rate = 0;  // [s], [s], 1
  double jitter = 0;                         // of each stamp, one standard deviation [s]
  bool is_that_of_run() const { return file.empty() && time.empty() && latency == 0 && offset == 0 && rate == 0; }
};

// What a sensor makes of what it measures, as its maker says. Numbers of the channel's unit.
struct Readout {
  double low_pass = 0;                            // cut-off of a first-order low pass [Hz]; 0: none
  double resolution = 0;                          // step between two readings; 0: not said
  double lowest = -INFINITY, highest = INFINITY;  // beyond which it is saturated
};

struct RecordedChannel {
  ChannelKind kind = {};
  std::vector<std::string> columns;  // of RecordedRun::table
  ChannelClock clock;
  Readout readout;
  std::vector<std::string> written;  // with a clock of its own: the columns as its file names them
  std::string joint, body, unit;
  std::optional<Vec3> point;        // of a marker, rest position in the body's frame [m]
  int vertex = -1;                  // of a marker instead
  std::optional<Vec3> axis;         // of a position or marker with one column: its part along this direction
  std::string other_body;           // of a distance: the body of its other end; of a contact: the only one that counts
  Vec3 other_point = Vec3::Zero();  // of a distance: the other end in that body's frame [m]
  std::string constant;             // of a current: effort per current, such as 0.05 N m/A
  double threshold = 0;             // of a contact: the force at which it is felt [N]
  double noise = -1;                // one sigma, in `unit`; negative: unknown
  int source = -1;                  // of pictures: which of Recording::mask_sources or video_sources
  int part = -1;  // then: which moment (mask_metrics.hpp) or cell (picture_cells.hpp), a channel for each
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
  bool has_robots_alone = false;  // the scene is a task's robots without anything else (robot_set.hpp)
  std::vector<RecordedRun> runs;
  std::vector<RecordedInput> inputs;
  std::vector<RecordedChannel> channels;
  std::vector<MaskSource> mask_sources;
  std::vector<VideoSource> video_sources;
  Initial initial = Initial::first_sample;
  std::map<std::string, double> given;  // "joint/NAME/position", "joint/NAME/velocity" -> SI
  StatedNumbers priors;                 // of numbers of the scene, with the names of RecordedRun::set
};

// `path`: the folder or its recording.yaml. Throws a UsageError that names file, line and key.
Recording load_recording(const std::filesystem::path& path);

}  // namespace pvg
