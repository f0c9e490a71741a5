// The program's commands as functions of their options; main.cpp reads the options from the command line. They return
// when they are done and report everything else by exceptions (host/base/error.hpp).
#pragma once
#include <cstdint>
#include <string>

#include "pipeline/episode/episode.hpp"

namespace pvg {

struct DevicesOptions {
  bool as_json = false;
};

// phyvisgen devices: what OpenCL finds on this machine.
void run_devices(const DevicesOptions& options);

struct GenerateOptions {
  std::string task, folder;  // task file, folder of the set
  std::uint64_t n_episodes = 1, seed = 0;
  std::string shard = "0/1";  // i/n: every n-th episode, from the i-th on
  std::string device;         // as for Device; empty: the best
  std::string render_device;  // empty: a second GPU of the same kind, where neither is named, else `device`
  PictureOverrides pictures;
  std::size_t frames_under_way = 3;  // bound of the stage graph
  bool no_render = false;            // states only
  bool keep_failed = false;          // keep the record of failed episodes
  bool retries_failed = false;       // make failed episodes again
  bool as_json = false, is_verbose = false;
  bool shows_graph = false;  // print the graph and nothing else
  bool is_rigid = false;     // fingers that do not bend
};

// phyvisgen generate: episodes of a task, simulated, rendered and recorded into a folder.
void run_generate(const GenerateOptions& options);

struct StatusOptions {
  std::string folder;  // of a set
  bool as_json = false;
};

// phyvisgen status: what of a set is done, failed and why, missing; reads files only.
void run_status(const StatusOptions& options);

struct MergeOptions {
  std::vector<std::string> folders;  // parts of one set
  std::string output;                // may be one of them
  bool removes = false;              // the parts, once they are merged
  bool mixes_devices = false;        // parts of several devices or drivers: an episode's bits depend on who made it
};

// phyvisgen merge: parts of one set into one folder. A UsageError where they are of different origin. What is there
// already stays, so that it can be called again.
void run_merge(const MergeOptions& options);

struct PackOptions {
  std::string folder, output;        // of a set, of the data set
  std::string format = "lerobot";    // lerobot, lerobot2, act, robomimic, zarr
  std::string instruction;           // what the robot is told to do; empty: the task's name in words
  std::vector<std::string> cameras;  // names; empty: all
};

// phyvisgen pack: the finished episodes of a set as a data set that imitation learning loads.
void run_pack(const PackOptions& options);

struct SubmitOptions {
  std::string task, folder;  // task file, folder of the set
  std::uint64_t n_episodes = 1, n_shards = 1, seed = 0;
  std::uint64_t n_at_once = 0;                                // shards that run at a time; 0: all
  std::vector<std::string> generate_options, sbatch_options;  // for generate; lines for Slurm, such as --partition=gpu
  bool runs = false;                                          // submit, not only write
};

// phyvisgen submit: a Slurm array job that makes the set in shards and a job that merges them, in DIR/jobs.
void run_submit(const SubmitOptions& options);

struct ViewOptions {
  std::string folder, output;    // of a set or of an episode, HTML file
  std::uint64_t n_episodes = 6;  // of a set, shown with videos and motion; all others stand in the table
};

// phyvisgen view: one HTML page that needs nothing else, of a set or of an episode.
void run_view(const ViewOptions& options);

struct EvaluateOptions {
  std::string folder;     // of a set that generate made
  std::size_t every = 1;  // look for intersections in each so many steps
  bool as_json = false;
};

// phyvisgen evaluate: the success rate of a set with its interval, the reasons of failures, and the recorded steps in
// which surfaces intersect. A Failure where one does.
void run_evaluate(const EvaluateOptions& options);

struct RateInterval {
  double low = 0, high = 1;
};
// Of a rate seen as `successes` in n trials, 95 %.
RateInterval wilson_interval(std::size_t successes, std::size_t n);

struct SimulateOptions {
  std::string scene, file;          // scene file, states file
  double duration = -1;             // [s]; negative: what the scene says
  std::string resume;               // checkpoint to go on from; empty: from the start
  double checkpoint_every = 0;      // simulated time between checkpoints [s]; 0: none
  std::string animation;            // binary glTF to write as well; empty: none
  double pictures_per_second = 25;  // of the animation
  std::string device;
  bool as_json = false, is_verbose = false;
};

// phyvisgen simulate: a scene file to states.h5. Checkpoints are written to FILE.checkpoint.h5, each over the one
// before; after a step that failed, FILE holds what there is and the checkpoint the last state that was well.
void run_simulate(const SimulateOptions& options);

struct RenderOptions {
  std::string scene, states;         // scene or task file, states file; empty: the start
  std::string output;                // folder, or FILE.png, .exr, .mp4; may be empty where a glTF is written
  std::string gltf;                  // .glb to write as well: the scene as the first frame shows it
  std::vector<std::string> cameras;  // names; empty: all
  std::string frames;                // A:B; empty: all
  double frames_per_second = 0;      // of states without pictures, and of videos; 0: what the file says
  int width = 0, height = 0;         // [pixels]; 0: what the file says
  int samples = 0, max_depth = 0;    // 0: what the file says
  bool caustics = false;             // glass blocks shadow rays; what it bends of a lamp's light falls on matte things
  std::uint64_t seed = 0;
  std::string lut;                   // .csv of calibrate lut; empty: what the file says
  bool writes_ground_truth = false;  // CAMERA_truth.h5 beside the pictures
  bool sees_through_glass = false;   // ground truth: of what is behind glass
  bool denoises = false;
  std::string device;
  bool is_verbose = false;
};

// phyvisgen render: pictures of a scene, or of a recorded motion.
void run_render(const RenderOptions& options);

struct CalibrateLutOptions {
  std::string rendered, real;  // folders of pictures, paired by name
  std::string output;          // .csv
  bool as_json = false;
};

// phyvisgen calibrate lut: a lookup table from rendered to recorded pictures.
void run_calibrate_lut(const CalibrateLutOptions& options);

struct ValidateOptions {
  std::vector<std::string> cases;  // names; empty: all
  std::string scenes, plots;       // folders; empty: data/validation, no plots
  std::string recordings;          // folder of measured data; empty: ../shared/realdata beside the source tree
  std::string device;
  bool is_quick = false, as_json = false;
  bool uses_all_recordings = false;
  bool lists = false;  // print the names of the chosen cases and nothing else
};

// phyvisgen validate: the validation cases. A Failure if a number that must hold does not.
void run_validate(const ValidateOptions& options);

struct DiagnoseOptions {
  std::string recording, folder;  // folder of recording.yaml, folder of the report
  std::string device;
  int max_effects = 2;                // named together
  double minutes = 10;                // after which nothing further is looked for
  std::string decide = "workflow";    // or, to compare: retune, lowest, weak
  bool only_checks = false;           // say what is wrong with the recording and end
  bool lists_effects = false;         // print the names of all candidates and end
  bool lists_criteria = false;        // print the constants that decide and end
  std::vector<std::string> criteria;  // NAME=VALUE of such constants
  bool keeps_simulations = false;     // the journal is not removed at the end
  bool does_not_simulate = false;     // end with an error where the journal does not hold a result
  std::string suite;                  // folder of cases instead of a recording
  int n_jobs = 0;                     // cases at once, or processes of one; 0: one case, as many processes as cores
  bool as_json = false;
};

// phyvisgen diagnose: where a recording and its scene disagree, and what is missing.
void run_diagnose(const DiagnoseOptions& options);

struct BenchPhysicsOptions {
  std::vector<std::string> scenes;  // names; empty: all
  std::string device;
  std::size_t repeats = 3;
  bool as_json = false;
  bool lists = false;          // print the names and nothing else
  std::string preconditioner;  // instead of the scenes' own; empty: those
};

// phyvisgen bench physics: what a step costs on named scenes.
void run_bench_physics(const BenchPhysicsOptions& options);

struct BenchSolverOptions {
  std::vector<std::string> scenes = {"block_16k"};
  std::string device;
  std::size_t repeats = 3;
  bool as_json = false;
};

// phyvisgen bench solver: preconditioners and products side by side on one linear system.
void run_bench_solver(const BenchSolverOptions& options);

struct BenchRenderOptions {
  std::vector<std::string> scenes;  // names; empty: all
  std::string device;
  int repeats = 5;
  bool as_json = false;
};

// phyvisgen bench render: rays, trees and frames, measured.
void run_bench_render(const BenchRenderOptions& options);

}  // namespace pvg
