// The main job: one episode of a task, from its seed to its folder.
#pragma once
#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/load/build_scene.hpp"
#include "host/model/task.hpp"
#include "host/render/renderer.hpp"
#include "pipeline/episode/shared_simulation.hpp"
#include "pipeline/episode/success.hpp"
#include "pipeline/graph/graph.hpp"

namespace pvg {

struct EpisodeSettings {
  std::uint64_t seed = 0, episode = 0;
  bool renders = true;
  std::vector<std::string> cameras;  // whose pictures are rendered, by name; empty: all of the task
  std::size_t frames_under_way = 3;  // bound of the stage graph; no result depends on it
  std::size_t simulation = 0;        // which of the devices' takes the episode; no result depends on it
};

// Sums over the steps of an episode.
struct SolverTotals {
  std::int64_t steps = 0, newton = 0, cg = 0, retries = 0;
  int most_newton = 0, most_contacts = 0;
  double min_gap = 0;   // smallest of all steps [m]
  double residual = 0;  // largest of all steps [m/s]
};

struct MeshSize {
  std::string name;
  std::size_t nodes = 0, elements = 0, triangles = 0;
};

struct EpisodeReport {
  bool has_succeeded = false;
  std::string reason;  // of the failure, one sentence
  Measured measured;
  SolverTotals solver;
  std::size_t n_frames = 0;
  double time_step = 0, frames_per_second = 0;          // [s], [1/s]
  std::vector<MeshSize> meshes;                         // of the simulation
  std::vector<std::pair<std::string, double>> seconds;  // wall-clock time at work, by stage [s]
  std::string device, render_device, denoiser;          // denoiser empty: none
};

// The stages in their order, as a table of graph.hpp; for `--graph` and the README.
Table episode_table();

// The task with other pictures than its file says: 0 keeps what the file says.
struct PictureOverrides {
  int width = 0, height = 0, samples = 0;  // [pixels], [pixels], per pixel
  double frames_per_second = 0;
};
void apply(const PictureOverrides& overrides, Task& task);

// With --no-render: whoever gave an option of pictures expects pictures. A UsageError that names it.
void check_no_pictures(const PictureOverrides& overrides, const std::string& render_device);

// The same task with fingers that do not bend.
void make_grippers_rigid(Task& task);

// Whether the pictures of this camera are rendered and recorded.
bool shows(const EpisodeSettings& settings, const std::string& camera);

// Seed of an episode's pictures: neighbouring episodes share no noise.
std::uint64_t picture_seed(std::uint64_t seed, std::uint64_t episode);
// How the pictures of an episode are made, of `generate` and of `serve` alike.
RenderSettings picture_settings(const Task& task, std::uint64_t seed, std::uint64_t episode);

// What the episodes under way share.
struct EpisodeDevices {
  EpisodeDevices(Device& physics, Device& rendering) : rendering(rendering) { simulations.emplace_back(physics); }
  // Episodes are simulated beside each other, one simulation on each device; the devices outlive this.
  EpisodeDevices(std::span<Device> physics, Device& rendering) : rendering(rendering) {
    for (Device& device : physics) simulations.emplace_back(device);
  }
  std::deque<SharedSimulation> simulations;
  Device& rendering;
  std::mutex rendering_turn;  // one frame at a time
};

// Simulates, renders and records into `folder`, which exists. A motion that cannot be planned, a start that intersects
// and a step that could not be done are failed episodes with their reason; other errors are thrown. `advance` hears of
// every frame that is on record, of how many. Several threads may run an episode each with the same devices.
EpisodeReport run_episode(const Task& task, const EpisodeSettings& settings, EpisodeDevices& devices,
                          const std::filesystem::path& folder, const std::atomic<bool>& stop,
                          const std::function<void(std::size_t done, std::size_t total)>& advance);

// summary.json of an episode's folder.
std::string summary_json(const Task& task, const EpisodeSettings& settings, const EpisodeReport& report);

// Name and version of what made an episode, or a simulation; of the device that renders where it is of another kind,
// and of the denoiser where pictures are denoised.
std::vector<std::pair<std::string, std::string>> versions(const Device& physics, const Device& rendering,
                                                          bool denoises = false);

}  // namespace pvg
