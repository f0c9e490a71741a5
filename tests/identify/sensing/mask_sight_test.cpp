// Masks as a recording's cameras would have seen them in the simulation
#include "host/identify/sensing/mask_sight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/hdf5/file.hpp"
#include "host/identify/data/noise.hpp"
#include "host/identify/fit/fit.hpp"
#include "host/identify/fit/time_step.hpp"
#include "host/identify/report/report.hpp"
#include "host/load/overview.hpp"
#include "host/render/renderer.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr int MASK_WIDTH = 64, MASK_HEIGHT = 48;

// A plate whose front of 0.2 x 0.1 m is 1 m from a pinhole of 100 pixels, and a blind before the left half of it; 8
// masks of this size and part.
std::filesystem::path plate(const TestFolder& folder, std::uint64_t height, const std::string& part) {
  folder.write("scene.yaml", R"(schema: 1
name: plate
time_step: 5 ms
duration: 0.1 s
bodies:
  - {name: plate, kind: rigid, shape: {box: {size: [0.2, 0.02, 0.1]}}, mass: 1, pose: {position: [0, 0.01, 0]}}
  - {name: blind, kind: static, shape: {box: {size: [0.5, 0.001, 0.5]}}, pose: {position: [-0.25, -0.1, 0]}}
cameras:
  - {name: wrist, width: 64, height: 48, intrinsics: [100, 100, 31.5, 23.5], position: [0, -1, 0], look_at: [0, 0, 0], up: [0, 0, 1]}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i < 8; ++i) run += std::to_string(0.01 * i) + ",0," + std::to_string(0.01 + 0.001 * i) + ",0\n";
  folder.write("a.csv", run);
  hdf5::File file = hdf5::File::create(folder.path / "masks.h5");
  file.write<std::uint8_t>("/part", {8, height, MASK_WIDTH}, std::vector<std::uint8_t>(8 * height * MASK_WIDTH, 1));
  file.attribute("/part", "names", std::vector<std::string>{"nothing", part});
  file.close();
  return folder.write("recording.yaml",
                      "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n"
                      "  - {columns: [x, y, z], kind: position, body: plate, unit: m}\n"
                      "  - {file: masks.h5, kind: mask, camera: wrist, part: " +
                          part + "}\n");
}

TEST(MaskSight, APlateBehindABlindIsSeenByItsFreeHalf) {
  const TestFolder folder;
  const Problem problem = make_problem(plate(folder, MASK_HEIGHT, "plate"));
  Device device;
  MaskSight sight(device, problem);
  const std::vector<std::uint8_t> mask = sight.look(0, initial_state(problem.seen));
  // 20 x 10 pixels in the middle, of which the right 10 x 10 are free
  ASSERT_EQ(mask.size(), std::size_t(MASK_WIDTH * MASK_HEIGHT));
  for (int row = 0; row < MASK_HEIGHT; ++row)
    for (int column = 0; column < MASK_WIDTH; ++column)
      EXPECT_EQ(int(mask[std::size_t(row * MASK_WIDTH + column)]),
                int(column >= 32 && column < 42 && row >= 19 && row < 29))
          << row << " " << column;
}

TEST(MaskSight, MasksThatDoNotFitTheirCameraOrSceneAreRefused) {
  const TestFolder folder;
  expect_error<UsageError>([&] { make_problem(plate(folder, MASK_HEIGHT - 8, "plate")); },
                           {"a.csv", "64 x 40", "`wrist`", "64 x 48"});
  expect_error<UsageError>([&] { make_problem(plate(folder, MASK_HEIGHT, "gripper")); }, {"`gripper`", "plate, blind"});
}

// A disc that flies across the corner of a wide picture, weightless; its masks through a lens of this k1, which the
// scene's camera does not have.
constexpr std::uint64_t N_MASKS = 11, W = 128, V = 96;

std::string flight_scene(const std::string& lens) {
  return R"(schema: 1
name: flight
gravity: [0, 0, 0]
time_step: 45 ms
duration: 1 s
bodies:
  - {name: disc, kind: rigid, shape: {sphere: {radius: 0.12, subdivisions: 3}}, mass: 1, pose: {position: [-0.4, 0, -0.3]}, velocity: [1.6, 0, 1.2]}
cameras:
  - {name: wrist, width: 128, height: 96, intrinsics: [100, 100, 63.5, 47.5], position: [0, -1, 0], look_at: [0, 0, 0], up: [0, 0, 1])" +
         lens + "}\n";
}

SceneState disc_flown(const Scene& scene, double time) {
  SceneState state = initial_state(scene);
  state.time = time;
  state.rigid[0].col(3) += time * Vec3(1.6, 0, 1.2);
  return state;
}

std::filesystem::path mask_flight(const TestFolder& folder, double k1) {
  const std::filesystem::path truth =
      folder.write("true.yaml", flight_scene(", distortion: [" + std::to_string(k1) + ", 0, 0, 0]"));
  folder.write("scene.yaml", flight_scene(""));
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n"
               "  - {file: masks.h5, kind: mask, camera: wrist, part: disc}\n");
  Scene scene = load_scene_run(truth).scene;
  complete_for_viewing(scene);
  Device device;
  Renderer renderer(device, scene, RenderSettings{.samples = 1});
  std::string run = "t\n";
  std::vector<std::uint8_t> pixels;
  for (std::uint64_t i = 0; i < N_MASKS; ++i) {
    const double time = 0.045 * double(i);
    run += std::to_string(time) + "\n";
    renderer.set_state(disc_flown(scene, time));
    for (const std::uint32_t instance : renderer.instances(0)) pixels.push_back(std::uint8_t(instance));
  }
  folder.write("a.csv", run);
  hdf5::File file = hdf5::File::create(folder.path / "masks.h5");
  file.write<std::uint8_t>("/part", {N_MASKS, V, W}, pixels);
  file.attribute("/part", "names", std::vector<std::string>{"nothing", "disc"});
  file.close();
  return folder.path / "recording.yaml";
}

TEST(MaskSight, AddedDistortionIsThatOfACameraWhoseFileSaysSo) {
  const TestFolder folder;
  const Problem problem = make_problem(mask_flight(folder, -0.1));
  const PartMasks& seen = problem.recording.runs[0].masks[0].masks;
  Device device;
  MaskSight sight(device, problem);
  int n_bent = 0;
  for (const std::size_t frame : {0, 3, 10, 0}) {
    const SceneState state = disc_flown(problem.seen, 0.045 * double(frame));
    EXPECT_EQ(sight.look(0, state, -0.1), seen.pixels[frame]) << frame;
    n_bent += sight.look(0, state) != seen.pixels[frame];
  }
  EXPECT_GE(n_bent, 3);
}

TEST(MaskSight, MasksTellTheDistortionOfTheirCamerasLensToAFewPerCent) {
  const TestFolder folder;
  Problem problem = make_problem(mask_flight(folder, -0.1));
  measure_noise(problem);
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  fitter.expect_whole_pixels();  // a small change moves few pixels, and found -0.0950 +- 0.0003 here
  const FitData data = fitter.prepare(make_windows(problem, false, 0, 1), Model{});
  ASSERT_EQ(data.windows.size(), 1u);
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto lens = std::find_if(candidates.begin(), candidates.end(),
                                 [](const Candidate& candidate) { return candidate.name == "lens_distortion"; });
  ASSERT_NE(lens, candidates.end());
  EXPECT_EQ(lens->target, "wrist");
  const Model off{{&*lens}, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 0.3)};
  const Fit before = fitter.begin(data, {off}).front();
  const Fit fit = fitter.fit(data, {off}, 6).front();
  ASSERT_TRUE(fit.succeeded);
  EXPECT_NEAR(fit.model.x[0], -0.1, 0.002);
  EXPECT_LT(std::sqrt(fit.covariance(0, 0)), 0.02);
  EXPECT_LT(rms(fit.residual), 0.2 * rms(before.residual));
}

TEST(MaskSight, TheStepsErrorIsNotCorrectedByMasksOfWholePixels) {
  const TestFolder folder;
  Problem problem = make_problem(mask_flight(folder, 0));
  measure_noise(problem);
  Device device;
  Predictor predictor(device, problem);
  Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const std::string text = choose_time_step(fitter, predictor, problem, base);
  EXPECT_NE(text.find("which is not corrected"), std::string::npos) << text;
  for (const Window& window : fitter.prepare(make_windows(problem, false, 0, 1), Model{}).windows)
    EXPECT_EQ(window.correction.size(), 0);
}

TEST(MaskSight, TheAmendedScenesCameraHasTheLensThatWasFound) {
  const TestFolder folder;
  const Problem problem = make_problem(mask_flight(folder, -0.1));
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto lens = std::find_if(candidates.begin(), candidates.end(),
                                 [](const Candidate& candidate) { return candidate.name == "lens_distortion"; });
  ASSERT_NE(lens, candidates.end());
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::measurement;
  diagnosis.effects = {{&*lens, {{"k1", "1", -0.125, -0.13, -0.12}}}};
  diagnosis.used = problem.scene.scene;
  const std::string text = amended_scene(problem, diagnosis, folder.path);
  EXPECT_NE(text.find("# the measurement: lens_distortion at wrist, k1 -0.125"), std::string::npos) << text;
  const Scene amended = load_scene_run(folder.write("amended.yaml", text)).scene;
  EXPECT_EQ(amended.cameras.at(0).distortion, (std::vector<double>{-0.125, 0, 0, 0}));
}

}  // namespace
}  // namespace pvg::diagnose
