// A small Weigh Beaker from task file to folder: coarse linear fingers, tiny pictures, quick motion, but the whole
// task. What must hold is checked on the recorded files, not on what the program says of itself.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "host/formats/picture_files.hpp"
#include "host/formats/video_reader.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/hdf5/file.hpp"
#include "host/load/task_file.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/episode/motion_plan.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

Task small_task() {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "tasks/weigh_beaker.yaml");
  for (FingerSection& finger : task.gripper->fingers) finger.nodes_per_element = 4;
  for (MotionElement& element : task.motion) {
    element.speed = std::min(1.0, 2 * element.speed);
    if (element.duration > 0) element.duration = 0.5;
  }
  PictureOverrides pictures;
  pictures.width = 64;
  pictures.height = 36;
  pictures.samples = 1;
  pictures.frames_per_second = 5;
  apply(pictures, task);
  return task;
}

EpisodeReport make(const Task& task, const fs::path& folder, std::size_t frames_under_way) {
  fs::create_directories(folder);
  EpisodeSettings settings;
  settings.seed = 5;
  settings.episode = 2;
  settings.frames_under_way = frames_under_way;
  Device physics, rendering;
  EpisodeDevices devices(physics, rendering);
  const std::atomic<bool> stop = false;
  return run_episode(task, settings, devices, folder, stop, [](std::size_t, std::size_t) {});
}

// What a reader has of an episode.
struct Recorded {
  explicit Recorded(const fs::path& folder) : file(hdf5::File::open(folder / "states.h5")) {
    names = file.texts_attribute("/bodies", "names");
    data_sets = file.texts_attribute("/bodies", "data_sets");
    source = file.read<std::int64_t>("/bodies/source").values;
    row = file.read<std::int64_t>("/bodies/row").values;
    for (const std::string& name : data_sets) states[name] = file.read<double>(name);
    n_steps = file.shape("/time").at(0);
  }
  std::size_t body(const std::string& name) const {
    return std::size_t(std::find(names.begin(), names.end(), name) - names.begin());
  }
  AffineMap map(std::size_t b, std::size_t step) const {
    const hdf5::Array<double>& poses = states.at(data_sets[std::size_t(source[b])]);
    const double* at = &poses.values[(step * poses.shape[1] + std::size_t(row[b])) * 12];
    return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(at);
  }
  bool is_soft(std::size_t b) const { return source[b] > 1; }
  std::vector<Vec3> vertices(std::size_t b, const std::vector<double>& rest, std::size_t step) const {
    std::vector<Vec3> points;
    for (std::size_t v = 0; v < rest.size() / 3; ++v) {
      if (is_soft(b))
        points.emplace_back(&states.at(data_sets[std::size_t(source[b])]).values[step * rest.size() + 3 * v]);
      else
        points.push_back(map(b, step) * Eigen::Vector4d(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2], 1));
    }
    return points;
  }

  hdf5::File file;
  std::vector<std::string> names, data_sets;
  std::vector<std::int64_t> source, row;
  std::map<std::string, hdf5::Array<double>> states;
  std::size_t n_steps = 0;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// One run serves all checks of this file: ctest gives each test a process of its own.
struct Small {
  fs::path root = fs::temp_directory_path() / ("pvg_end_to_end_" + std::to_string(getpid()));
  Task task = small_task();
  ~Small() { fs::remove_all(root); }
};

void the_beaker_is_lifted_never_dropped_and_ends_upright_on_the_scale(const Small& small, const EpisodeReport& report) {
  EXPECT_TRUE(report.has_succeeded) << report.reason;
  const Recorded recorded(small.root / "a");
  const std::size_t beaker = recorded.body("beaker"), scale = recorded.body("scale");
  const Vec3 start = recorded.map(beaker, 0).col(3);
  double highest = 0;
  for (std::size_t step = 0; step < recorded.n_steps; ++step)
    highest = std::max(highest, recorded.map(beaker, step)(2, 3) - start.z());
  EXPECT_GE(highest, 0.10);
  const AffineMap end = recorded.map(beaker, recorded.n_steps - 1), pan = recorded.map(scale, recorded.n_steps - 1);
  const Vec3 goal = pan.leftCols<3>() * small.task.success.at(1).target_position + pan.col(3);
  EXPECT_LE((end.col(3) - goal).norm(), 0.010);
  EXPECT_GE(end.col(2).normalized().z(), std::cos(0.03));
}

void fingers_deform_and_the_beaker_does_not_slip(const Small&, const EpisodeReport& report) {
  EXPECT_GE(report.measured.finger_deformation, 1e-3);
  EXPECT_LE(report.measured["slip_in_hand_m"], 1e-3);
  EXPECT_LE(report.measured["moved_in_hand_m"], 5e-3);
}

void no_two_surfaces_intersect_at_any_recorded_step(const Small& small, const EpisodeReport&) {
  const Recorded recorded(small.root / "a");
  std::set<std::pair<std::size_t, std::size_t>> free_pairs;
  const auto pairs = recorded.file.read<std::int64_t>("/bodies/noncolliding").values;
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2)
    free_pairs.insert(std::minmax(std::size_t(pairs[i]), std::size_t(pairs[i + 1])));
  const auto is_fixed = recorded.file.read<std::int64_t>("/bodies/is_fixed").values;

  std::vector<std::uint32_t> triangle_body;
  std::vector<Triangle> triangles;
  std::vector<std::pair<std::size_t, std::vector<double>>> meshes;  // body, rest
  std::uint32_t first_point = 0;
  for (const std::string& name : recorded.file.children("/mesh")) {
    const auto body = std::size_t(recorded.file.read<std::int64_t>("/mesh/" + name + "/body").values.at(0));
    const auto corners = recorded.file.read<std::uint32_t>("/mesh/" + name + "/triangles").values;
    meshes.emplace_back(body, recorded.file.read<double>("/mesh/" + name + "/rest").values);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      triangles.push_back({first_point + corners[i], first_point + corners[i + 1], first_point + corners[i + 2]});
      triangle_body.push_back(std::uint32_t(body));
    }
    first_point += std::uint32_t(meshes.back().second.size() / 3);
  }
  ASSERT_GT(triangles.size(), 1000u);
  std::vector<Edge> edges;
  std::vector<std::uint32_t> edge_body;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a > b) continue;  // closed surfaces: the neighbour has it the other way round
      edges.push_back({a, b});
      edge_body.push_back(triangle_body[t]);
    }
  const auto may_overlap = [&](std::uint32_t edge, std::uint32_t triangle) {
    const std::size_t a = edge_body[edge], b = triangle_body[triangle];
    if (a == b) return !recorded.is_soft(a);
    return (is_fixed[a] && is_fixed[b]) || free_pairs.contains(std::minmax(a, b));
  };
  for (std::size_t step = 0; step < recorded.n_steps; ++step) {
    std::vector<Vec3> points;
    for (const auto& [body, rest] : meshes) {
      const std::vector<Vec3> moved = recorded.vertices(body, rest, step);
      points.insert(points.end(), moved.begin(), moved.end());
    }
    const auto found = find_intersection(points, edges, triangles, may_overlap);
    ASSERT_FALSE(found.has_value()) << "step " << step << ": " << recorded.names[edge_body[found->edge]] << " and "
                                    << recorded.names[triangle_body[found->triangle]];
  }
}

void every_tetrahedron_keeps_a_positive_volume(const Small& small, const EpisodeReport&) {
  const Recorded recorded(small.root / "a");
  for (const std::string name : {"finger_left", "finger_right"}) {
    const auto elements = recorded.file.read<std::uint32_t>("/mesh/" + name + "/elements");
    const auto rest = recorded.file.read<double>("/mesh/" + name + "/rest").values;
    ASSERT_GT(elements.shape.at(0), 100u);
    for (std::size_t step = 0; step < recorded.n_steps; ++step) {
      const std::vector<Vec3> x = recorded.vertices(recorded.body(name), rest, step);
      for (std::size_t e = 0; e < elements.shape[0]; ++e) {
        const std::uint32_t* node = &elements.values[e * elements.shape[1]];
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = x[node[k + 1]] - x[node[0]];
        ASSERT_GT(edges.determinant(), 0) << name << ", element " << e << ", step " << step;
      }
    }
  }
}

void the_folder_is_complete_and_its_parts_fit_together(const Small& small, const EpisodeReport& report) {
  for (const char* name : {"states.h5", "front.mp4", "wrist.mp4", "wrist_masks.h5", "contact_sheet.png"})
    EXPECT_GT(fs::file_size(small.root / "a" / name), 100u) << name;
  EXPECT_FALSE(fs::exists(small.root / "a/front_masks.h5"));  // not asked for
  for (const char* name : {"start/front.mp4", "start/wrist.mp4"})
    EXPECT_EQ(read_video(small.root / "a" / name, 64, 36, 0, [](auto) {}), 1u) << name;
  const Recorded recorded(small.root / "a");
  const std::vector<double> home = recorded.file.read<double>("/start/q").values;
  EXPECT_EQ(home.size(), 9u);
  EXPECT_EQ(home[1], small.task.robot.home[1]);
  const auto frame_step = recorded.file.read<std::int64_t>("/frame_step").values;
  ASSERT_EQ(frame_step.size(), report.n_frames);
  EXPECT_EQ(std::size_t(frame_step.back()), recorded.n_steps - 1);
  EXPECT_EQ(recorded.n_steps, frame_step.size() * steps_per_frame(5, small.task.solver.time_step));
  const hdf5::File masks = hdf5::File::open(small.root / "a/wrist_masks.h5");
  EXPECT_EQ(masks.shape("/part"), (hdf5::Shape{frame_step.size(), 36, 64}));
  // the wrist camera looks at the fingers: the gripper covers some of every picture, and never all
  const auto names = masks.texts_attribute("/part", "names");
  const auto gripper = std::uint8_t(std::find(names.begin(), names.end(), "gripper") - names.begin());
  ASSERT_LT(gripper, names.size());
  const auto part = masks.read<std::uint8_t>("/part").values;
  for (std::size_t f = 0; f < frame_step.size(); ++f) {
    const auto n = std::count(part.begin() + std::ptrdiff_t(f * 64 * 36),
                              part.begin() + std::ptrdiff_t((f + 1) * 64 * 36), gripper);
    EXPECT_GT(n, 64 * 36 / 50) << "frame " << f;
    EXPECT_LT(n, 64 * 36) << "frame " << f;
  }
  EXPECT_GE(read_picture(small.root / "a/contact_sheet.png").width,
            4 * 64);  // four pictures beside each other at least
}

TEST(EndToEnd, ASmallEpisodeKeepsEveryPromise) {
  const Small small;
  const EpisodeReport report = make(small.task, small.root / "a", 3);
  ASSERT_EQ(report.reason, "");
  the_beaker_is_lifted_never_dropped_and_ends_upright_on_the_scale(small, report);
  fingers_deform_and_the_beaker_does_not_slip(small, report);
  no_two_surfaces_intersect_at_any_recorded_step(small, report);
  every_tetrahedron_keeps_a_positive_volume(small, report);
  the_folder_is_complete_and_its_parts_fit_together(small, report);
}

TEST(EndToEnd, OneSeedGivesTheSameBitsWhateverTheBoundOfTheGraph) {
  // the first element is enough: planning, contact with the table, pictures, files
  const Small small;
  Task brief = small.task;
  brief.motion.resize(1);
  brief.motion[0].speed = 1;
  for (const auto& [name, frames_under_way] : {std::pair("b", 3), {"c", 1}})
    make(brief, small.root / name, std::size_t(frames_under_way));
  for (const char* name : {"states.h5", "front.mp4", "wrist.mp4", "wrist_masks.h5", "contact_sheet.png"}) {
    EXPECT_GT(fs::file_size(small.root / "b" / name), 100u) << name;
    EXPECT_TRUE(bytes_of(small.root / "b" / name) == bytes_of(small.root / "c" / name)) << name;
  }
}

}  // namespace
}  // namespace pvg
