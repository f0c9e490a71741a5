// Against what other people measured: tosses of a cube, and a silicone beam that bends under a load. Reported as it is.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/statistics.hpp"
#include "host/formats/table.hpp"
#include "pipeline/validation/cases.hpp"
#include "pipeline/validation/free_flight.hpp"

namespace pvg {
namespace {

constexpr double FRAME = 1.0 / 148, WIDTH = 0.1048;  // of the recordings of tosses [s], of their cube [m]
constexpr std::size_t MOST_TOSSES = 40;              // unless all are asked for
// metres of the recordings per metre: in them cubes fly with 9.60 m/s^2 and rest with their centres 51.2 mm high
constexpr double LENGTH_SCALE = 0.9785;
constexpr double FREE_ABOVE = 8e-3;        // a cube flies until its lowest corner is so near to the table [m]
constexpr std::size_t FRAMES_IN_HAND = 3;  // before them the rate of turn is by 0.2 to 0.5 rad/s not that of the flight
constexpr std::size_t FEWEST_FRAMES = 5;   // of a flight to which a start is fitted: if need be those in the hand, too

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

// What a toss was, frame by frame, in metres.
struct Toss {
  std::vector<Pose> pose;
  FlightStart recorded;  // at the first frame
};

std::vector<Toss> tosses_of(const MeasuredTable& r) {
  std::vector<Toss> tosses;
  for (std::size_t i = 0; i < r.n_rows; ++i) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond(r["qw"][i], r["qx"][i], r["qy"][i], r["qz"][i]).normalized().matrix();
    pose.translation() = Vec3(r["px"][i], r["py"][i], r["pz"][i]) / LENGTH_SCALE;
    if (r["frame"][i] == 0)  // the recorded rate of turn is the body's
      tosses.push_back({{},
                        {pose, Vec3(r["vx"][i], r["vy"][i], r["vz"][i]) / LENGTH_SCALE,
                         pose.linear() * Vec3(r["wx"][i], r["wy"][i], r["wz"][i])}});
    tosses.back().pose.push_back(pose);
  }
  return tosses;
}

// At most `most`, evenly spaced.
std::vector<Toss> evenly_spaced(const std::vector<Toss>& all, std::size_t most) {
  const std::size_t n = std::min(most, all.size());
  std::vector<Toss> chosen;
  for (std::size_t i = 0; i < n; ++i) chosen.push_back(all[i * all.size() / n]);
  return chosen;
}

// Frames before the lowest corner comes near to the table.
std::size_t count_free(const Toss& toss) {
  const auto is_near = [](const Pose& pose) {
    const double below = WIDTH / 2 * pose.linear().row(2).cwiseAbs().sum();
    return pose.translation().z() - below < FREE_ABOVE;
  };
  return std::size_t(std::find_if(toss.pose.begin(), toss.pose.end(), is_near) - toss.pose.begin());
}

FlightStart flight_of(const Toss& toss, const Vec3& gravity) {
  const std::size_t end = count_free(toss);
  const std::size_t first = std::min(FRAMES_IN_HAND, end - std::min(end, FEWEST_FRAMES));
  return fit_flight(toss.pose, FRAME, first, end, gravity);
}

// Means over the frames of one toss after its first.
struct TossError {
  double position = 0, rotation = 0;  // [share of the width], [rad]
  void add(const AffineMap& simulated, const Pose& seen) {
    const Mat3 turn = seen.linear().transpose() * simulated.leftCols<3>();
    position += (simulated.col(3) - seen.translation()).norm() / WIDTH;
    rotation += std::abs(Eigen::AngleAxisd(Eigen::Quaterniond(turn).normalized()).angle());
  }
};

// All tosses side by side, as worlds of one simulation.
std::vector<TossError> simulate_tosses(Validation& v, const SceneRun& run, const std::vector<Toss>& tosses,
                                       const std::vector<FlightStart>& starts) {
  const int cube = rigid_index(run.scene, "cube");
  std::vector<PhysicalScene> worlds;
  std::size_t n_frames = 0;
  for (const Toss& toss : tosses) n_frames = std::max(n_frames, toss.pose.size());
  for (const FlightStart& start : starts) {
    worlds.push_back(run.scene);
    RigidBody& body = worlds.back().rigid_bodies[cube];
    body.pose = start.pose;
    body.velocity = start.velocity;
    body.angular_velocity = start.angular_velocity;
  }
  Simulation simulation(v.device, worlds);
  const StepCheck check(run.scene);
  const int n_steps = int(std::lround(FRAME / run.scene.solver.time_step));  // per frame
  const std::vector<std::vector<double>> no_targets(worlds.size());
  std::vector<TossError> errors(tosses.size());
  for (std::size_t frame = 1; frame < n_frames; ++frame) {
    for (int i = 0; i < n_steps; ++i) {
      v.stop_if_asked();
      const std::vector<StepReport> reports = simulation.step(no_targets);
      for (std::size_t w = 0; w < tosses.size(); ++w) check.look(simulation.state(w), reports[w], v.counts);
    }
    for (std::size_t w = 0; w < tosses.size(); ++w)
      if (frame < tosses[w].pose.size()) errors[w].add(simulation.state(w).rigid[cube], tosses[w].pose[frame]);
  }
  for (std::size_t w = 0; w < tosses.size(); ++w) {
    errors[w].position /= double(tosses[w].pose.size() - 1);
    errors[w].rotation /= double(tosses[w].pose.size() - 1);
  }
  return errors;
}

// How far the tip went down from its hold, relative to the base, over the mean of its markers; the mean of all files.
double measured_deflection(const std::vector<std::filesystem::path>& files) {
  std::vector<double> deflections;
  for (const auto& file : files) {
    const MeasuredTable r = read_table(file);
    // mean of a marker's height over the time that it is held, and once it has come to rest
    const auto fall = [&](const std::string& marker) {
      const std::vector<double>&t = r["t"], &x = r[marker + "_x"];
      std::vector<double> held, at_rest;
      for (std::size_t i = 0; i < r.n_rows; ++i) {
        if (t[i] < 0.3) held.push_back(x[i]);
        if (t[i] > t.back() - 0.5) at_rest.push_back(x[i]);
      }
      return mean(held) - mean(at_rest);
    };
    double tip = 0, base = 0;
    for (const char* number : {"1", "2", "3"}) {
      tip += fall(std::string("Tip-") + number) / 3;
      base += fall(std::string("Base-") + number) / 3;
    }
    deflections.push_back(tip - base);
  }
  return mean(deflections);
}

// In n cells across and 3 n along; the scene's own mesh has 4.
double simulated_deflection(Validation& v, double mass, int n) {
  SceneRun run = v.load("silicone_beam");
  set_divisions(run, Vec3(0.1, 0.03, 0.03), {3 * n, n, n}, 10);
  RigidBody& weight = run.scene.rigid_bodies[rigid_index(run.scene, "weight")];
  weight.inertia *= mass / weight.mass;
  weight.mass = mass;
  WorldState last;
  v.run(run, [&](const WorldState& state, const StepReport&) {
    const bool moves = last.rigid.empty() || std::abs(state.rigid[1](2, 3) - last.rigid[1](2, 3)) > 1e-8;
    last = state;
    return moves;
  });
  return -last.rigid[rigid_index(run.scene, "weight")](2, 3);
}

void report_tosses(Validation& v, const std::vector<TossError>& errors, const std::string& start,
                   const std::string& source) {
  std::vector<double> position, rotation;
  for (const TossError& error : errors) {
    position.push_back(100 * error.position);
    rotation.push_back(180 / std::acos(-1.0) * error.rotation);
  }
  v.report("position error, mean" + start, "% width", 0, mean(position), source + "12");
  v.report("position error, median" + start, "% width", 0, median(position), source + "12");
  v.report("rotation error, mean" + start, "deg", 0, mean(rotation), source + "15");
  v.report("rotation error, median" + start, "deg", 0, median(rotation), source + "15");
}

}  // namespace

void validate_cube_toss(Validation& v) {
  const std::filesystem::path file = v.recordings / "cube_toss/tosses.csv";
  if (!std::filesystem::exists(file)) return v.skip(file.string() + " is not there");
  const std::vector<Toss> all = tosses_of(read_table(file));
  const std::vector<Toss> tosses = evenly_spaced(all, v.uses_all_recordings ? all.size() : MOST_TOSSES);
  const SceneRun run = v.load("cube_toss");
  const std::string source =
      "measured: " + std::to_string(tosses.size()) + " tosses of 148 Hz; one parameter set, chosen on all; ";
  std::vector<FlightStart> fitted, recorded;
  for (const Toss& toss : tosses) {
    fitted.push_back(flight_of(toss, run.scene.gravity));
    recorded.push_back(toss.recorded);
  }
  report_tosses(v, simulate_tosses(v, run, tosses, fitted), "", source + "starts fitted to the flight; goal ");
  report_tosses(v, simulate_tosses(v, run, tosses, recorded), ", recorded start", source + "starts as recorded; goal ");
}

void validate_silicone_beam(Validation& v) {
  const std::filesystem::path folder = v.recordings / "dragonskin_beam";
  const auto unloaded = tables_in(folder, "beam_gravity"), loaded = tables_in(folder, "beam_load52");
  if (unloaded.empty() || loaded.empty()) return v.skip(folder.string() + " holds no recordings");
  // coarser meshes first: what is left of the error is the model's
  for (const int n : {2, 3, 4}) {
    const std::string mesh = ", " + std::to_string(n) + " cells across";
    const std::string source = "measured; modulus as published";
    v.report("tip deflection, unloaded" + mesh, "m", measured_deflection(unloaded), simulated_deflection(v, 1e-6, n),
             source);
    v.report("tip deflection, 52 g" + mesh, "m", measured_deflection(loaded), simulated_deflection(v, 0.052, n),
             source);
  }
}

}  // namespace pvg
