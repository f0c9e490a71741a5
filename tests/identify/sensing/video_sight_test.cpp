// Pictures as a recording's cameras would have taken them, and what their sensors do to them
#include "host/identify/sensing/video_sight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/formats/picture_files.hpp"
#include "host/hdf5/file.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/fit.hpp"
#include "host/load/overview.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr std::uint64_t N_FRAMES = 9, WIDTH = 48, HEIGHT = 36;
constexpr double APART = 0.1;  // of frames [s]

// A ball that flies across the picture, weightless, before a wall.
std::string scene_text(const std::string& camera) {
  return R"(schema: 1
name: flight
gravity: [0, 0, 0]
time_step: 50 ms
duration: 1 s
bodies:
  - {name: ball, kind: rigid, shape: {sphere: {radius: 0.15, subdivisions: 2}}, mass: 1, pose: {position: [-0.4, 0, -0.2]}, velocity: [1, 0, 0.5]}
  - {name: wall, kind: static, shape: {box: {size: [3, 0.1, 3]}}, pose: {position: [0, 1, 0]}}
cameras:
  - {name: wrist, width: 48, height: 36, intrinsics: [40, 40, 23.5, 17.5], position: [0, -1, 0], look_at: [0, 0, 0], up: [0, 0, 1])" +
         camera + "}\n";
}

SceneState flown(const Scene& scene, double time) {
  SceneState state = initial_state(scene);
  state.time = time;
  state.rigid[0].col(3) += time * Vec3(1, 0, 0.5);
  return state;
}

// Pictures by a camera of which the scene does not know `camera`, with other random numbers than it uses.
std::filesystem::path flight(const TestFolder& folder, const std::string& camera, const std::string& channel = "") {
  const std::filesystem::path truth = folder.write("true.yaml", scene_text(camera));
  folder.write("scene.yaml", scene_text(""));
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n" +
                   (channel.empty() ? "  - {file: \"{run}.h5\", kind: video, camera: wrist}\n" : channel));
  Scene scene = load_scene_run(truth).scene;
  complete_for_viewing(scene);
  Device device;
  Renderer renderer(device, scene, RenderSettings{.samples = 64, .max_depth = 8, .seed = 7});
  std::string run = "t\n";
  std::vector<std::uint8_t> rgb;
  for (std::uint64_t i = 0; i < N_FRAMES; ++i) {
    run += std::to_string(APART * double(i)) + "\n";
    renderer.set_state(flown(scene, APART * double(i)));
    const RenderedFrame frame = renderer.render(0, std::uint32_t(i));
    const Picture8 picture = encode_srgb8(frame.rgb, frame.width, frame.height);
    rgb.insert(rgb.end(), picture.rgb.begin(), picture.rgb.end());
  }
  folder.write("a.csv", run);
  hdf5::File file = hdf5::File::create(folder.path / "a.h5");
  file.write("/rgb", {N_FRAMES, HEIGHT, WIDTH, 3}, rgb);
  file.close();
  return folder.path / "recording.yaml";
}

TEST(VideoSight, GainAndVignettingAreThoseOfACameraWhoseFileSaysSoAndNeedNoNewPicture) {
  const TestFolder folder;
  const Problem problem = make_problem(flight(folder, ", exposure: 1.3, vignetting: [-0.4]"));
  Device device;
  VideoSight sight(device, problem);
  const SceneState state = flown(problem.seen, 0.3);
  const PictureCells plain = sight.look(0, state, 3), bright = sight.look(0, state, 3, {0, 1.3, 0}),
                     both = sight.look(0, state, 3, {0, 1.3, -0.4}), noise = sight.noise(0, state);
  EXPECT_EQ(sight.n_rendered(), 1u);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(bright[i], 1.3 * plain[i], 1e-6) << i;
    const double measured = problem.runs[0].values[i][3];
    EXPECT_NEAR(both[i], measured, 4 * noise[i] + 0.002) << i;  // and half a step of 8 bits
    EXPECT_GT(noise[i], 0);
    EXPECT_LT(noise[i], 0.02 * plain[i]) << i;
  }
}

// the candidate's fit from where it is off
Fit fit_of(Fitter& fitter, const FitData& data, const Candidate& candidate) {
  const Parameter& p = candidate.parameters[0];
  return fitter
      .fit(data, {{{&candidate}, Eigen::VectorXd::Constant(1, p.off), Eigen::VectorXd::Constant(1, p.scale)}}, 4)
      .front();
}

void expect_named(const std::string& camera, const std::string& name, double value) {
  const TestFolder folder;
  Problem problem = make_problem(flight(folder, camera));
  Device device;
  Predictor predictor(device, problem);
  measure_noise(problem);
  add_noise_of_pictures(*predictor.video(), problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{}, false);
  ASSERT_EQ(data.windows.size(), 1u);
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  int n_tried = 0;
  for (const Candidate& candidate : candidates) {
    if (candidate.name != "exposure" && candidate.name != "vignetting") continue;
    ++n_tried;
    EXPECT_EQ(candidate.target, "wrist");
    const Fit fit = fit_of(fitter, data, candidate);
    ASSERT_TRUE(fit.succeeded);
    if (candidate.name != name) {
      EXPECT_GT(rms(fit.residual), 2) << candidate.name;
      continue;
    }
    EXPECT_NEAR(fit.model.x[0], value, 2 * std::sqrt(fit.covariance(0, 0)));
    EXPECT_LT(std::sqrt(fit.covariance(0, 0)), 0.02);
    EXPECT_LT(rms(fit.residual), 1.2);
  }
  EXPECT_EQ(n_tried, 2);
}

TEST(VideoSight, AVideoTellsItsCamerasExposure) { expect_named(", exposure: 1.3", "exposure", 1.3); }

TEST(VideoSight, AVideoTellsItsCamerasVignetting) { expect_named(", vignetting: [-0.4]", "vignetting", -0.4); }

TEST(VideoSight, VideosThatDoNotFitTheirSceneAreRefused) {
  const TestFolder folder;
  const std::filesystem::path file = flight(folder, "");
  const auto refused = [&](const std::string& channel, std::initializer_list<const char*> words) {
    folder.write("recording.yaml",
                 "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n  - " + channel);
    expect_error<UsageError>([&] { make_problem(file); }, words);
  };
  refused("{file: a.h5, kind: video, camera: front}\n", {"`front`", "does not have"});
  refused("{file: b.h5, kind: video, camera: wrist}\n", {"b.h5"});
  refused("{file: a.h5, kind: video, camera: wrist, first_frame: 1}\n", {"first_frame", "frames_per_second"});
  refused("{file: a.h5, kind: video, camera: wrist, frames_per_second: 0.01, first_frame: 5}\n",
          {"a.h5", "no picture has the time of a row"});
  refused("{file: \"{run}.h5\", kind: video, camera: wrist}\n  - {file: a.h5, kind: video, camera: wrist}\n",
          {"camera", "one per camera"});
  folder.write("a.csv", "t\n0\n1\n2\n3\n4\n5\n6\n7\n8\n9\n");
  refused("{file: a.h5, kind: video, camera: wrist}\n", {"a.h5", "9 pictures", "10 rows", "frames_per_second"});
  folder.write("a.csv", "t\n0\n1\n2\n3\n4\n5\n6\n7\n8\n");
  hdf5::File small = hdf5::File::create(folder.path / "a.h5");
  small.write("/rgb", {9, 32, 48, 3}, std::vector<std::uint8_t>(9 * 32 * 48 * 3, 1));
  small.close();
  refused("{file: a.h5, kind: video, camera: wrist}\n", {"a.csv", "48 x 32", "`wrist`", "48 x 36"});
}

}  // namespace
}  // namespace pvg::diagnose
