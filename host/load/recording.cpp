#include "host/load/recording.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "host/base/error.hpp"
#include "host/formats/picture_series.hpp"
#include "host/load/fields/yaml_section.hpp"
#include "host/load/read_sections.hpp"
#include "host/pictures/mask_metrics.hpp"

namespace pvg {
namespace {

using Kind = RecordedChannel::Kind;
constexpr double SAME_TIME = 1e-4;  // of a picture and a row [s]
const std::vector<std::string> KINDS = {"position", "rate",  "torque", "orientation",
                                        "marker",   "force", "mask",   "video"};

RecordedRun read_run(YamlSection& section) {
  RecordedRun run;
  run.name = section.text("file");
  run.is_held_out = section.choice("role", {"fit", "held_out"}) == 1;
  try {
    run.table = read_table(section.file("file"));
  } catch (const Failure& failure) {
    throw UsageError(failure.what());
  }
  section.done();
  const std::string file = run.table.file.string();
  if (!run.table.has("t")) throw UsageError(file + " has no column `t`, the time in seconds; name its first column so");
  const std::vector<double>& t = run.table["t"];
  if (t.size() < 8) throw UsageError(file + " holds " + std::to_string(t.size()) + " rows; a run needs at least 8");
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) throw UsageError(file + ": the time of row " + std::to_string(i + 1) + " is missing");
    if (i > 0 && !(t[i] > t[i - 1]))
      throw UsageError(file + ": the time of row " + std::to_string(i + 1) + " does not come after the one before");
  }
  return run;
}

std::vector<std::string> read_columns(YamlSection& section) {
  if (section.has("column") == section.has("columns"))
    section.fail("", "must have either `column`, one name, or `columns`, a list of names");
  return section.has("column") ? std::vector<std::string>{section.text("column")} : section.texts("columns");
}

RecordedInput read_input(YamlSection& section) {
  RecordedInput input{read_columns(section), section.text("target"), section.text("unit", "")};
  section.done();
  return input;
}

// one sigma, or unknown
double read_noise(YamlSection& section) {
  const std::string text = section.text("noise", "unknown");
  if (text == "unknown") return -1;
  double value = 0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data(), end, value).ptr != end || !(value > 0) || !std::isfinite(value))
    section.fail("noise", "must be one sigma in the channel's unit, above 0, or `unknown`");
  return value;
}

// one channel for each moment of a mask
void read_masks(YamlSection& section, Recording& recording) {
  const int source = int(recording.mask_sources.size());
  recording.mask_sources.push_back({section.text("file"), section.text("camera"), section.text("part")});
  section.done();
  const MaskSource& masks = recording.mask_sources.back();
  for (std::size_t moment = 0; moment < N_MASK_MOMENTS; ++moment) {
    RecordedChannel channel;
    channel.kind = Kind::mask;
    channel.mask_source = source;
    channel.moment = int(moment);
    channel.columns = {"mask of " + masks.part + " by " + masks.camera + ", " + MASK_MOMENT_NAMES[moment]};
    recording.channels.push_back(std::move(channel));
  }
}

std::string column_of(const VideoSource& video, std::size_t cell) {
  return "video of " + video.camera + ", " + cell_name(cell);
}

// one channel for each cell of the pictures
void read_video(YamlSection& section, Recording& recording) {
  VideoSource video{section.text("file"), section.text("camera")};
  for (const VideoSource& other : recording.video_sources)
    if (other.camera == video.camera) section.fail("camera", "has a video above; give one per camera");
  if (section.has("frames_per_second"))
    video.frames_per_second = section.number("frames_per_second", Unit::none, 1e-3, 1e6);
  if (section.has("first_frame")) {
    if (video.frames_per_second == 0) section.fail("first_frame", "needs `frames_per_second` beside it");
    video.first_frame = section.number("first_frame", Unit::time, -1e6, 1e6);
  }
  const double noise = read_noise(section);
  section.done();
  for (std::size_t cell = 0; cell < N_PICTURE_CELLS; ++cell) {
    RecordedChannel channel;
    channel.kind = Kind::video;
    channel.video_source = int(recording.video_sources.size());
    channel.cell = int(cell);
    channel.noise = noise;
    channel.columns = {column_of(video, cell)};
    recording.channels.push_back(std::move(channel));
  }
  recording.video_sources.push_back(std::move(video));
}

// the pictures' file of a run: beside its table, {run} stands for the table's name without its ending
std::filesystem::path pictures_of(const RecordedRun& run, std::string name) {
  const std::string token = "{run}";
  if (const std::size_t at = name.find(token); at != std::string::npos)
    name.replace(at, token.size(), run.table.file.stem().string());
  return run.table.file.parent_path() / name;
}

// which of n pictures was seen in which row of the table: by their times, or one after the other; what: they are
std::vector<int> frames_of_rows(const std::vector<double>& time, std::size_t n, const std::vector<double>& t,
                                const std::string& file, const std::string& what) {
  std::vector<int> frame_of_row(t.size(), -1);
  if (time.empty()) {
    if (n != t.size())
      throw UsageError(file + " holds " + std::to_string(n) + " " + what + "s and no /time, its run " +
                       std::to_string(t.size()) + " rows; give one " + what + " per row, or /time [s]" +
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
  const std::filesystem::path file = pictures_of(run, source.file);
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
  for (std::size_t k = 0; k < N_MASK_MOMENTS; ++k)
    run.table.columns["mask of " + source.part + " by " + source.camera + ", " + MASK_MOMENT_NAMES[k]] =
        std::move(columns[k]);
  run.masks.push_back(std::move(recorded));
}

void add_video(const VideoSource& source, RecordedRun& run) {
  const std::filesystem::path file = pictures_of(run, source.file);
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

RecordedChannel read_channel(YamlSection& section) {
  RecordedChannel channel;
  const std::vector<std::string> more = {"velocity", "effort"};
  std::vector<std::string> names = KINDS;
  names.insert(names.end(), more.begin(), more.end());
  std::size_t kind = section.choice("kind", names);
  if (kind == KINDS.size()) kind = std::size_t(Kind::rate);
  if (kind == KINDS.size() + 1) kind = std::size_t(Kind::torque);
  channel.kind = Kind(kind);
  channel.columns = read_columns(section);
  channel.joint = section.text("joint", "");
  channel.body = section.text("body", "");
  if (channel.joint.empty() == channel.body.empty()) section.fail("", "must name either a `joint` or a `body`");
  channel.unit = section.text("unit", "");
  if (section.has("point")) channel.point = section.vector("point", Unit::length, -REACH, REACH);
  if (section.has("vertex")) channel.vertex = section.integer("vertex", 0, 100000000);
  if (section.has("axis")) {
    channel.axis = section.vector("axis", Unit::none, -1e6, 1e6);
    if (!(channel.axis->norm() > 1e-9)) section.fail("axis", "must not have the length zero");
    channel.axis->normalize();
  }
  channel.noise = read_noise(section);
  const bool is_point = channel.kind == Kind::marker;
  if (is_point && channel.point.has_value() == (channel.vertex >= 0))
    section.fail("", "is a marker and needs either `point`, its rest position in the body's frame, or `vertex`");
  if (!is_point && (channel.point || channel.vertex >= 0))
    section.fail("", "has a `point` or `vertex`, which only the kind `marker` has");
  const bool is_of_joint = !channel.joint.empty();
  if (is_of_joint && channel.kind != Kind::position && channel.kind != Kind::rate && channel.kind != Kind::torque)
    section.fail("kind", "of a joint must be position, rate or torque");
  if (!is_of_joint && (channel.kind == Kind::rate || channel.kind == Kind::torque))
    section.fail("kind", "of a body must be position, orientation, marker or force");
  const std::size_t n = is_of_joint || channel.axis ? 1 : channel.kind == Kind::orientation ? 4 : 3;
  if (channel.columns.size() != n)
    section.fail(section.has("column") ? "column" : "columns",
                 "must name " + std::to_string(n) + (n == 1 ? " column" : " columns") +
                     (n == 3 ? "; one is enough where `axis` gives its direction" : ""));
  section.done();
  return channel;
}

void read_initial(YamlSection& root, Recording& recording) {
  if (!root.has("initial")) return;
  const YAML::Node node = YAML::LoadFile(recording.file.string())["initial"];
  if (!node.IsMap()) {
    recording.initial = Recording::Initial(root.choice("initial", {"first_sample", "fitted"}));
    return;
  }
  recording.initial = Recording::Initial::given;
  YamlSection section = root.section("initial");
  for (const auto& entry : node) {
    const std::string key = entry.first.Scalar();
    recording.given[key] = section.number(key, Unit::none, -1e6, 1e6);
  }
  section.done();
}

bool is_same(const MeasuredTable& a, const MeasuredTable& b) {
  const auto same_number = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::equal(
      a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(), [&](const auto& x, const auto& y) {
        return x.first == y.first &&
               std::equal(x.second.begin(), x.second.end(), y.second.begin(), y.second.end(), same_number);
      });
}

// A held-out run that the fit has seen proves nothing, and a run that stands twice counts twice.
void demand_different_runs(const Recording& recording) {
  const std::vector<RecordedRun>& runs = recording.runs;
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (is_same(runs[i].table, runs[k].table))
        throw UsageError(recording.file.string() + ": the runs " + runs[k].name + " and " + runs[i].name +
                         " hold the same numbers" +
                         (runs[i].is_held_out != runs[k].is_held_out
                              ? ", so the held out one proves nothing; record another motion for it"
                              : "; leave one of them away"));
}

}  // namespace

const char* kind_name(RecordedChannel::Kind kind) { return KINDS[std::size_t(kind)].c_str(); }

Recording load_recording(const std::filesystem::path& path) {
  Recording recording;
  recording.file = std::filesystem::is_directory(path) ? path / "recording.yaml" : path;
  YamlSection root = YamlSection::load(recording.file, "recording");
  check_schema(root);
  recording.scene = root.file("scene");
  for (YamlSection& section : root.sections("runs")) recording.runs.push_back(read_run(section));
  for (YamlSection& section : root.sections("inputs")) recording.inputs.push_back(read_input(section));
  for (YamlSection& section : root.sections("channels")) {
    const std::string kind = section.has("kind") ? section.text("kind") : "";
    if (kind == "mask")
      read_masks(section, recording);
    else if (kind == "video")
      read_video(section, recording);
    else
      recording.channels.push_back(read_channel(section));
  }
  read_initial(root, recording);
  root.done();
  if (recording.runs.empty()) root.fail("runs", "holds no run: there is nothing to compare with");
  if (recording.channels.empty()) root.fail("channels", "holds no channel: nothing was measured");
  demand_different_runs(recording);
  for (RecordedRun& run : recording.runs) {
    for (const MaskSource& source : recording.mask_sources) add_masks(source, run);
    for (const VideoSource& source : recording.video_sources) add_video(source, run);
  }
  for (const RecordedRun& run : recording.runs) {
    const auto check = [&](const std::vector<std::string>& columns, const std::string& key) {
      for (const std::string& column : columns)
        if (!run.table.has(column))
          root.fail(key, "names the column `" + column + "`, which " + run.table.file.string() + " does not have");
    };
    for (const RecordedInput& input : recording.inputs) check(input.columns, "inputs");
    for (const RecordedChannel& channel : recording.channels) check(channel.columns, "channels");
  }
  return recording;
}

}  // namespace pvg
