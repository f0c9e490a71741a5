// summary.json: what became of an episode, and what it cost.
#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/render/renderer.hpp"
#include "pipeline/episode/episode.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Measured& measured) {
  Json json = Json::object();
  for (const Measured::Number& number : measured.numbers) json[number.name] = number.value;
  json["finger_deformation_m"] = measured.finger_deformation;
  return json;
}

Json to_json(const SolverTotals& solver) {
  return {{"steps", solver.steps},
          {"newton", solver.newton},
          {"most_newton_in_a_step", solver.most_newton},
          {"cg", solver.cg},
          {"retries", solver.retries},
          {"most_contacts", solver.most_contacts},
          {"min_gap_m", solver.min_gap},
          {"largest_residual_m_per_s", solver.residual}};
}

Json to_json(const std::vector<MeshSize>& meshes) {
  Json sizes = Json::object();
  for (const MeshSize& mesh : meshes)
    sizes[mesh.name] = {{"nodes", mesh.nodes}, {"elements", mesh.elements}, {"triangles", mesh.triangles}};
  return sizes;
}

template <class T>
Json to_json(const std::vector<std::pair<std::string, T>>& pairs) {
  Json object = Json::object();
  for (const auto& [name, value] : pairs) object[name] = value;
  return object;
}

std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace

std::vector<std::pair<std::string, std::string>> versions(const Device& physics, const Device& rendering,
                                                          bool denoises) {
  const DeviceInfo &simulates = physics.info(), &renders = rendering.info();
  std::vector<std::pair<std::string, std::string>> all = {
      {"phyvisgen", PVG_VERSION}, {"opencl_device", simulates.name}, {"opencl_driver", simulates.driver}};
  if (renders.name != simulates.name || renders.driver != simulates.driver) {
    all.emplace_back("opencl_render_device", renders.name);
    all.emplace_back("opencl_render_driver", renders.driver);
  }
  if (denoises) all.emplace_back("denoiser", denoiser_name(rendering));
  return all;
}

std::string summary_json(const Task& task, const EpisodeSettings& settings, const EpisodeReport& report) {
  Json json = {{"schema", 1},
               {"task", task.name},
               {"seed", settings.seed},
               {"episode", settings.episode},
               {"success", report.has_succeeded},
               {"reason", report.reason},
               {"time_step_s", report.time_step},
               {"steps", report.solver.steps},
               {"frames", settings.renders ? report.n_frames : 0},
               {"frames_per_second", report.frames_per_second},
               {"duration_s", double(report.solver.steps) * report.time_step},
               {"samples_per_pixel", task.render.samples},
               {"adaptive_samples", task.render.adaptive}};
  Json& cameras = json["cameras"] = Json::object();
  for (const CameraSection& camera : task.cameras)
    if (shows(settings, camera.name)) cameras[camera.name] = {{"width", camera.width}, {"height", camera.height}};
  json["measured"] = to_json(report.measured);
  json["solver"] = to_json(report.solver);
  json["meshes"] = to_json(report.meshes);
  json["device"] = report.device;
  json["render_device"] = report.render_device;
  json["denoiser"] = report.denoiser.empty() ? "none" : report.denoiser;
  json["version"] = PVG_VERSION;
  json["seconds"] = to_json(report.seconds);
  json["peak_memory_bytes"] = peak_memory_bytes();
  return json.dump(2) + "\n";
}

}  // namespace pvg
