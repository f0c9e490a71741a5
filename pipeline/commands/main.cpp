// phyvisgen: the command line. Every error is one sentence on stderr.
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "host/base/error.hpp"
#include "pipeline/commands/command_line.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace {

// exit codes; 75 is EX_TEMPFAIL of sysexits.h, which batch systems read as "queue me again"
constexpr int DONE = 0, FAILED = 1, WRONG_USE = 2, TRY_AGAIN = 75;

int report(const char* message, int code) {
  std::fprintf(stderr, "phyvisgen: %s\n", message);
  return code;
}

void add_devices(CLI::App& program, pvg::DevicesOptions& o) {
  CLI::App* command = program.add_subcommand("devices", "List the OpenCL devices that --device can name");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen devices --json");
}

void add_generate(CLI::App& program, pvg::GenerateOptions& o) {
  CLI::App* command = program.add_subcommand("generate", "Simulate, render and record episodes of a task");
  command->add_option("TASK", o.task, "Task file (YAML)");
  command->add_option("-n,--episodes", o.n_episodes, "How many episodes the set has")
      ->check(CLI::Range(std::uint64_t(1), pvg::MOST_EPISODES))
      ->capture_default_str();
  command->add_option("--seed", o.seed, "Seed of the set; an episode depends on it and on its number alone")
      ->capture_default_str();
  command->add_option("--shard", o.shard, "i/n: make every n-th episode, from the i-th on")->capture_default_str();
  command->add_option("-o,--output", o.folder, "Folder of the set; finished episodes in it are skipped");
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_option("--render-device", o.render_device,
                      "The one that renders, if another; where neither is named: a second GPU of the same kind");
  command->add_option("--width", o.pictures.width, "Width of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--height", o.pictures.height, "Height of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--samples", o.pictures.samples, "Paths per pixel")->check(CLI::Range(1, 1 << 20));
  command->add_option("--fps", o.pictures.frames_per_second, "Frames per second of motion")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--frames-under-way", o.frames_under_way, "Frames in the stage graph at once")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_flag("--no-render", o.no_render, "Simulate and record states only");
  command->add_flag("--keep-failed", o.keep_failed, "Keep the record of failed episodes in DIR/failed");
  command->add_flag("--retry-failed", o.retries_failed,
                    "Make episodes again that failed before; they fail again unless the program has changed");
  command
      ->add_option_function<std::string>(
          "--gripper", [&o](const std::string& kind) { o.is_rigid = kind == "rigid"; },
          "soft, or rigid: the same fingers without bending, for comparison")
      ->check(CLI::IsMember({"soft", "rigid"}));
  command->add_flag("--graph", o.shows_graph, "Print the graph of the stages (mermaid) and end");
  command->add_flag("--json", o.as_json, "Print the state of the set as JSON at the end");
  command->add_flag("-v,--verbose", o.is_verbose, "Explain: meshes, solver, time per stage");
  command->footer(
      "Exit codes: 0 done, 1 failed, 2 wrong use, 75 stopped before the end: call again to continue.\n"
      "Example:\n  phyvisgen generate data/tasks/weigh_beaker.yaml --episodes 10 --seed 1 -o out/beaker -v\n"
      "  phyvisgen generate data/tasks/weigh_beaker.yaml --device 0 --render-device 1 -o out/beaker");
}

void add_status(CLI::App& program, pvg::StatusOptions& o) {
  CLI::App* command = program.add_subcommand("status", "What of an episode set is done, failed and missing");
  command->add_option("DIR", o.folder, "Folder of the set");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen status out/beaker");
}

void add_merge(CLI::App& program, pvg::MergeOptions& o) {
  CLI::App* command = program.add_subcommand("merge", "Put the parts of one episode set into one folder");
  command->add_option("DIR", o.folders, "Folders that generate has filled, of the same task, seed and options");
  command->add_option("-o,--output", o.output, "Folder of the whole set; episodes that are there already stay");
  command->add_flag("--mixed-devices", o.mixes_devices,
                    "Merge parts that were made on different devices, too; same bits are not promised across devices");
  command->add_flag("--remove", o.removes, "Remove the given folders once they are merged");
  command->footer("Example:\n  phyvisgen merge out/shards/* -o out/beaker");
}

void add_pack(CLI::App& program, pvg::PackOptions& o) {
  CLI::App* command = program.add_subcommand("pack", "Make a data set for imitation learning of an episode set");
  command->add_option("DIR", o.folder, "Folder of the set; its finished episodes are packed");
  command->add_option("--format", o.format, "lerobot (3.0), lerobot2 (2.1), act, robomimic or zarr (UMI)")
      ->check(CLI::IsMember({"lerobot", "lerobot2", "act", "robomimic", "zarr"}))
      ->capture_default_str();
  command->add_option("-o,--output", o.output, "Folder to make");
  command->add_option("--camera", o.cameras, "Only this camera; may stand several times")->allow_extra_args(false);
  command->add_option("--instruction", o.instruction, "What the robot is told to do; else the task's name in words");
  command->footer("Example:\n  phyvisgen pack out/beaker --format lerobot -o out/beaker_lerobot");
}

void add_submit(CLI::App& program, pvg::SubmitOptions& o) {
  CLI::App* command =
      program.add_subcommand("submit", "Make an episode set on a Slurm cluster: array job and merge job");
  command->add_option("TASK", o.task, "Task file (YAML)");
  command->add_option("-n,--episodes", o.n_episodes, "How many episodes the set has")
      ->check(CLI::Range(std::uint64_t(1), pvg::MOST_EPISODES));
  command->add_option("--shards", o.n_shards, "Into how many jobs it is split")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--at-once", o.n_at_once, "How many of them run at a time; else all");
  command->add_option("--seed", o.seed, "Seed of the set")->capture_default_str();
  command->add_option("-o,--output", o.folder,
                      "Folder of the set, which all nodes see; scripts and logs lie in its jobs");
  command
      ->add_option("--sbatch", o.sbatch_options, "A line for Slurm, such as --partition=gpu; may stand several times")
      ->allow_extra_args(false);
  command
      ->add_option("--generate", o.generate_options,
                   "An option for generate, such as --samples=64; may stand several times")
      ->allow_extra_args(false);
  command->add_flag("--run", o.runs, "Submit the jobs; else they are only written");
  command->footer(
      "Example:\n  phyvisgen submit data/tasks/weigh_beaker.yaml -n 10000 --shards 100 --sbatch=--gres=gpu:1 \\\n"
      "      --sbatch=--time=12:00:00 -o /shared/beaker --run");
}

void add_view(CLI::App& program, pvg::ViewOptions& o) {
  CLI::App* command = program.add_subcommand("view", "One HTML page of an episode or a set: videos, curves, 3D");
  command->add_option("DIR", o.folder, "Folder of a set or of an episode");
  command->add_option("-o,--output", o.output, "Page to write (.html); it needs no other file");
  command->add_option("-n,--episodes", o.n_episodes, "So many episodes of a set with videos and 3D")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->footer("Example:\n  phyvisgen view out/beaker -o beaker.html");
}

void add_evaluate(CLI::App& program, pvg::EvaluateOptions& o) {
  CLI::App* command =
      program.add_subcommand("evaluate", "Success rate of a set of episodes, and whether anything intersects in them");
  command->add_option("SET", o.folder,
                      "Folder that generate made; with --keep-failed the failed ones are looked at, too");
  command->add_option("--every", o.every, "Look for intersections in every so many recorded steps")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Exit codes: 0 nothing intersects, 1 something does, 2 wrong use.\n"
      "Example:\n  phyvisgen generate data/tasks/place_dish.yaml -n 20 --no-render --keep-failed -o out/dish\n"
      "  phyvisgen evaluate out/dish");
}

void add_simulate(CLI::App& program, pvg::SimulateOptions& o) {
  CLI::App* command = program.add_subcommand("simulate", "Simulate a scene file and record its states");
  command->add_option("SCENE", o.scene, "Scene file (YAML)");
  command->add_option("-o,--output", o.file, "States file (HDF5) to write");
  command->add_option("--duration", o.duration, "Simulated time [s]; else what the scene says")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--resume", o.resume,
                      "Checkpoint (HDF5) of the same scene to go on from; FILE holds what follows");
  command
      ->add_option("--checkpoint-every", o.checkpoint_every,
                   "Simulated time [s] after which FILE.checkpoint.h5 is renewed; else only after a failure")
      ->check(CLI::PositiveNumber);
  command->add_option("--animation", o.animation, "Animated binary glTF (.glb) to write as well, for any glTF viewer");
  command->add_option("--pictures-per-second", o.pictures_per_second, "Of the animation; 25 unless given")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print solver statistics as JSON at the end");
  command->add_flag("-v,--verbose", o.is_verbose, "Tell of every step: iterations, contacts, smallest gap");
  command->footer(
      "Examples:\n  phyvisgen simulate data/validation/pendulum.yaml -o pendulum.h5\n"
      "  phyvisgen simulate data/validation/drape.yaml -o drape.h5 --animation drape.glb\n"
      "  phyvisgen simulate data/scenes/two_arms.yaml -o arms.h5 --duration 0.5 --checkpoint-every 0.1\n"
      "  phyvisgen simulate data/scenes/two_arms.yaml -o rest.h5 --resume arms.h5.checkpoint.h5");
}

void add_render(CLI::App& program, pvg::RenderOptions& o) {
  CLI::App* command =
      program.add_subcommand("render", "Picture a scene, or a motion that simulate or generate recorded");
  command->add_option("SCENE", o.scene, "Scene or task file (YAML), or a glTF file (.glb, .gltf)");
  command->add_option("--states", o.states, "States file (HDF5) of that scene or task; else the start is shown");
  command->add_option("-o,--output", o.output,
                      "FILE.png, .jpg or .exr (linear), FILE.mp4, or a folder for one picture per camera and frame");
  command->add_option("--frames", o.frames, "A:B, the frames A to B - 1; or one frame");
  command->add_option("--camera", o.cameras, "Only this camera; may stand several times")->allow_extra_args(false);
  command->add_option("--samples", o.samples, "Paths per pixel; else what the file says")->check(CLI::Range(1, 65536));
  command->add_flag("--caustics", o.caustics,
                    "Light of lamps that glass bends onto matte things, instead of straight tinted shadows; noisier");
  command->add_option("--max-depth", o.max_depth, "Bounces; else what the file says")->check(CLI::Range(1, 1000));
  command->add_option("--width", o.width, "Of all pictures [pixels]; the field of view stays")
      ->check(CLI::Range(2, 16384));
  command->add_option("--height", o.height, "Of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--fps", o.frames_per_second, "Pictures per second of motion")->check(CLI::Range(0.01, 1000.0));
  command->add_option("--seed", o.seed, "Of the pictures' noise");
  command->add_option("--lut", o.lut, "Lookup table of `calibrate lut` (.csv); else what the file says");
  command->add_flag("--denoise", o.denoises, "Filter the noise of few samples, for previews");
  command->add_flag("--ground-truth", o.writes_ground_truth,
                    "Write CAMERA_truth.h5 as well: depth, normals, instances, parts, flow, boxes, poses");
  command->add_flag("--through-glass", o.sees_through_glass, "Ground truth of what is behind glass, not of the glass");
  command->add_option("--export", o.gltf,
                      "Write the first frame's scene as binary glTF (.glb), for Blender and others");
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("-v,--verbose", o.is_verbose, "Tell of every picture: rays, time, dropped samples");
  command->footer(
      "Examples:\n  phyvisgen render data/scenes/beaker_on_scale.yaml -o beaker.png --samples 64\n"
      "  phyvisgen render data/scenes/cornell_glass.yaml -o cornell.exr --samples 1024 --caustics\n"
      "  phyvisgen render model.glb -o model.png\n"
      "  phyvisgen render data/validation/drape.yaml --states drape.h5 -o drape.mp4 --fps 25\n"
      "  phyvisgen render data/tasks/weigh_beaker.yaml --states out/beaker/episode_000000/states.h5 --camera wrist \\\n"
      "      --frames 10:12 -o wrist");
}

void add_calibrate_lut(CLI::App& calibrate, pvg::CalibrateLutOptions& o) {
  CLI::App* command =
      calibrate.add_subcommand("lut", "A lookup table per channel from rendered to recorded colours of the same views");
  command->add_option("--render", o.rendered, "Folder of rendered pictures (PNG, JPEG)");
  command->add_option("--real", o.real, "Folder of the real ones; pairs have the same name");
  command->add_option("-o,--output", o.output, "Table to write (.csv)");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "A quarter of the pictures, or of the blocks of fewer than four, is held out to judge the table by.\n"
      "Example:\n  phyvisgen calibrate lut --render out/front --real photos -o lut.csv");
}

void add_validate(CLI::App& program, pvg::ValidateOptions& o) {
  CLI::App* command =
      program.add_subcommand("validate", "Run the validation cases and print measured against expected");
  command->add_option("--case", o.cases, "Only this case; may stand several times")->allow_extra_args(false);
  command->add_option("--plots", o.plots, "Folder for the curves (SVG)");
  command->add_option("--scenes", o.scenes, "Folder of the cases' scene files");
  command->add_option("--recordings", o.recordings, "Folder of the measured data; without it those cases are left out");
  command->add_flag("--all-recordings", o.uses_all_recordings, "Every recording of those cases, not a number of them");
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--quick", o.is_quick, "Only what is done within 3 minutes");
  command->add_flag("--list", o.lists, "Print the names of the chosen cases and end");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Exit codes: 0 all that must hold does, 1 something does not, 2 wrong use.\n"
      "Examples:\n  phyvisgen validate --case slope --plots out/plots\n"
      "  phyvisgen validate --case cube_toss --recordings ../shared/realdata --all-recordings");
}

void add_diagnose(CLI::App& program, pvg::DiagnoseOptions& o) {
  CLI::App* command = program.add_subcommand(
      "diagnose", "Find where a recording and its scene disagree, and name the effect that is missing");
  command->add_option("RECORDING", o.recording, "Folder with recording.yaml, or that file");
  command->add_option("-o,--output", o.folder, "Folder for report.html, report.json and scene_amended.yaml");
  command->add_option("--max-effects", o.max_effects, "Effects that may be named together")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  command
      ->add_option("--minutes", o.minutes,
                   "After so many nothing further is looked for: what was found till then is proved and reported")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  command
      ->add_option(
          "--decide", o.decide,
          "How to choose; all but `workflow` are for comparison: the best existing number, the lowest training "
          "error, sparse regression")
      ->check(CLI::IsMember({"workflow", "retune", "lowest", "weak"}))
      ->capture_default_str();
  command->add_flag("--check", o.only_checks, "Say what is wrong with the recording and end");
  command->add_flag("--list-effects", o.lists_effects, "Print all that can be named and end");
  command->add_flag("--list-criteria", o.lists_criteria, "Print the constants that decide a diagnosis and end");
  command->add_option("--set-criterion", o.criteria, "NAME=VALUE: another value of such a constant, for studies");
  command->add_flag("--keep-simulations", o.keeps_simulations,
                    "Leave the simulated results in simulated.bin, so that the next diagnosis in this folder reads "
                    "those that it needs, too");
  command->add_flag("--no-simulation", o.does_not_simulate,
                    "Read simulated.bin only: an error where it does not hold a result that is needed");
  command->add_option("--suite", o.suite, "Folder of hidden-effect cases: diagnose all, print the table of scores");
  command
      ->add_option(
          "--jobs", o.n_jobs,
          "Processes that simulate at once, by default one per core (of a suite: cases at once, by default one)")
      ->check(CLI::Range(1, 64));
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Examples:\n  phyvisgen diagnose recordings/pendulum -o out/pendulum\n"
      "  phyvisgen diagnose recordings/pendulum -o out/pendulum --jobs 1\n"
      "  phyvisgen diagnose recordings/pendulum --check\n  phyvisgen diagnose --list-effects --json\n"
      "  phyvisgen diagnose --suite data/hidden -o out/hidden --jobs 2");
}

void add_bench_physics(CLI::App& bench, pvg::BenchPhysicsOptions& o) {
  CLI::App* command = bench.add_subcommand("physics", "Time the simulator on named scenes");
  command->add_option("--scene", o.scenes, "Only this scene; may stand several times")->allow_extra_args(false);
  command->add_option("--repeats", o.repeats, "Runs of each scene; the median is printed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_option("--preconditioner", o.preconditioner, "Instead of what the scenes say")
      ->check(CLI::IsMember({"automatic", "factor", "schwarz", "block_jacobi"}));
  command->add_flag("--list", o.lists, "Print the names of the scenes and end");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Examples:\n  phyvisgen bench physics --scene mat_twist --scene towel --repeats 1\n"
      "  phyvisgen bench physics --scene block_64k --preconditioner schwarz");
}

void add_bench_solver(CLI::App& bench, pvg::BenchSolverOptions& o) {
  CLI::App* command =
      bench.add_subcommand("solver", "Preconditioners and products side by side on the last system of a scene");
  command->add_option("--scene", o.scenes, "A scene of bench physics; may stand several times")
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_option("--repeats", o.repeats, "Measured so often; medians are shown")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen bench solver --scene block_4k --scene towel");
}

void add_bench_render(CLI::App& bench, pvg::BenchRenderOptions& o) {
  CLI::App* command = bench.add_subcommand("render", "Rays per second, trees, frames; beside Embree where built in");
  command->add_option("--scene", o.scenes, "Only this one; may stand several times")->allow_extra_args(false);
  command->add_option("--repeats", o.repeats, "Measured so often after a warm-up; medians are shown")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen bench render --scene rays_100k --json");
}

int run(int argc, char** argv) {
  CLI::App program("Robot-learning data: soft-gripper manipulation, simulated with contact and path traced",
                   "phyvisgen");
  program.set_version_flag("--version", PVG_VERSION);
  program.require_subcommand(1);
  pvg::DevicesOptions devices;
  pvg::GenerateOptions generate;
  add_devices(program, devices);
  add_generate(program, generate);
  pvg::StatusOptions status;
  pvg::MergeOptions merge;
  add_status(program, status);
  add_merge(program, merge);
  pvg::PackOptions pack;
  add_pack(program, pack);
  pvg::SubmitOptions submit;
  add_submit(program, submit);
  pvg::ViewOptions view;
  add_view(program, view);
  pvg::EvaluateOptions evaluate;
  add_evaluate(program, evaluate);
  pvg::SimulateOptions simulate;
  pvg::RenderOptions render;
  pvg::ValidateOptions validate;
  add_simulate(program, simulate);
  add_render(program, render);
  CLI::App* calibrate = program.add_subcommand("calibrate", "Fit the renderer to a real camera");
  calibrate->require_subcommand(1);
  pvg::CalibrateLutOptions calibrate_lut;
  add_calibrate_lut(*calibrate, calibrate_lut);
  add_validate(program, validate);
  pvg::DiagnoseOptions diagnose;
  add_diagnose(program, diagnose);
  CLI::App* bench = program.add_subcommand("bench", "Measure speed and memory");
  bench->require_subcommand(1);
  pvg::BenchPhysicsOptions bench_physics;
  add_bench_physics(*bench, bench_physics);
  pvg::BenchSolverOptions bench_solver;
  add_bench_solver(*bench, bench_solver);
  pvg::BenchRenderOptions bench_render;
  add_bench_render(*bench, bench_render);
  pvg::make_numbers_strict(program);
  pvg::check_command_names(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& help) {
    program.exit(help);
    return DONE;
  } catch (const CLI::ParseError& error) {
    return report((std::string(error.what()) + " (--help shows how)").c_str(), WRONG_USE);
  }
  if (program.got_subcommand("devices")) pvg::run_devices(devices);
  if (program.got_subcommand("generate")) pvg::run_generate(generate);
  if (program.got_subcommand("status")) pvg::run_status(status);
  if (program.got_subcommand("merge")) pvg::run_merge(merge);
  if (program.got_subcommand("pack")) pvg::run_pack(pack);
  if (program.got_subcommand("submit")) pvg::run_submit(submit);
  if (program.got_subcommand("view")) pvg::run_view(view);
  if (program.got_subcommand("evaluate")) pvg::run_evaluate(evaluate);
  if (program.got_subcommand("simulate")) pvg::run_simulate(simulate);
  if (program.got_subcommand("render")) pvg::run_render(render);
  if (calibrate->got_subcommand("lut")) pvg::run_calibrate_lut(calibrate_lut);
  if (program.got_subcommand("validate")) pvg::run_validate(validate);
  if (program.got_subcommand("diagnose")) pvg::run_diagnose(diagnose);
  if (bench->got_subcommand("physics")) pvg::run_bench_physics(bench_physics);
  if (bench->got_subcommand("solver")) pvg::run_bench_solver(bench_solver);
  if (bench->got_subcommand("render")) pvg::run_bench_render(bench_render);
  return DONE;
}

}  // namespace

// What was freed is kept for the next step or picture: to ask the system anew, page by page, takes 5 to 8 % of the
// time of a towel's step. Where the library has no such choice nothing changes.
void keep_freed_memory() {
#ifdef M_MMAP_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

int main(int argc, char** argv) {
  keep_freed_memory();
  try {
    return run(argc, argv);
  } catch (const pvg::UsageError& error) {
    return report(error.what(), WRONG_USE);
  } catch (const pvg::TryAgain& error) {
    return report(error.what(), TRY_AGAIN);
  } catch (const pvg::Failure& error) {
    return report(error.what(), FAILED);
  } catch (const std::exception& error) {
    return report(pvg::sentence_of(error).c_str(), FAILED);
  }
}
