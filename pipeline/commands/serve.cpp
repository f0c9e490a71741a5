// phyvisgen serve: one process that steps a task or a scene for others, over its standard streams or a socket.
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "host/device/choose_device.hpp"
#include "host/load/scene_file.hpp"
#include "host/load/task_file.hpp"
#include "host/robot/imported_scene.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/program.hpp"
#include "pipeline/episode/episode.hpp"
#include "pipeline/serve/perturbation.hpp"
#include "pipeline/serve/scene_server.hpp"
#include "pipeline/serve/server.hpp"

namespace pvg {
namespace {

struct ServeOptions {
  std::string file;  // a task or a scene
  std::string device, render_device;
  std::string socket;  // path; empty: standard input and output
  std::vector<std::string> perturbations;
  PictureOverrides pictures;
  int n_worlds = 1;
  bool no_render = false, is_rigid = false;
};

// A file that closes.
class OpenFile {
 public:
  explicit OpenFile(int file) : file_(file) {}
  ~OpenFile() {
    if (file_ >= 0) close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  operator int() const { return file_; }

 private:
  int file_;
};

// A socket that nobody listens to any more: its server was ended by a signal.
bool is_left_over(const sockaddr_un& address) {
  std::error_code ignored;
  if (!std::filesystem::is_socket(address.sun_path, ignored)) return false;
  const int probe = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool refused =
      connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 && errno == ECONNREFUSED;
  close(probe);
  return refused;
}

// What to do about a path that is taken.
std::string hint(const std::string& path, int error) {
  if (error != EADDRINUSE) return "";
  std::error_code ignored;
  return std::filesystem::is_socket(path, ignored) ? ": another server listens there; choose another name"
                                                   : ": it is another file; choose another name";
}

// The socket that waits for clients; gone with its path at the end.
class Listener {
 public:
  explicit Listener(const std::string& path) : path_(path), file_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path)
      throw UsageError("--socket " + path + " is longer than the " + std::to_string(sizeof address.sun_path - 1) +
                       " bytes that a socket's path may have");
    path.copy(address.sun_path, path.size());
    if (is_left_over(address)) unlink(path.c_str());
    if (bind(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(file_, 1) != 0)
      throw UsageError("--socket " + path + " cannot be made: " + std::strerror(errno) + hint(path, errno));
  }
  ~Listener() { unlink(path_.c_str()); }
  int next_client() const {
    while (true) {
      const int client = accept4(file_, nullptr, nullptr, SOCK_CLOEXEC);
      if (client >= 0) return client;
      if (errno != EINTR) throw Failure("--socket " + path_ + " takes no clients: " + std::strerror(errno));
    }
  }

 private:
  std::string path_;
  OpenFile file_;
};

// What is served, a task or a scene.
class Served {
 public:
  explicit Served(const ServeOptions& options) {
    if (!is_robot_description(options.file) && is_task_file(options.file))
      load_task_of(options);
    else
      load_scene_of(options);
  }
  const std::string& name() const { return worlds_ ? worlds_->front().task().name : scene_->run().scene.name; }
  Message greet() const {
    return worlds_ ? greeting(*worlds_, program_version()) : greeting(*scene_, program_version());
  }
  void stream(int from, int to) {
    serve_stream(
        greet(), [&](const Message& request) { return worlds_ ? answer(*worlds_, request) : answer(*scene_, request); },
        from, to);
  }

 private:
  void load_task_of(const ServeOptions& options) {
    Task task = load_task(options.file);
    apply(options.pictures, task);
    if (options.is_rigid) make_grippers_rigid(task);
    for (const std::string& each : options.perturbations) perturb(task, read_perturbation(each));
    start_devices(options);
    worlds_.emplace(task, *physics_, rendering_ ? &*rendering_ : nullptr, std::size_t(options.n_worlds));
  }

  void load_scene_of(const ServeOptions& options) {
    const auto refuse = [&](bool is_given, const char* option) {
      if (is_given) throw UsageError(std::string(option) + " is for tasks; " + options.file + " is a scene");
    };
    refuse(options.n_worlds != 1, "--worlds");
    refuse(options.pictures.frames_per_second > 0, "--fps");
    refuse(options.is_rigid, "--gripper rigid");
    refuse(!options.perturbations.empty(), "--perturb");
    SceneRun run = load_scene_run(options.file);
    start_devices(options);
    scene_.emplace(std::move(run), options.pictures, *physics_, rendering_ ? &*rendering_ : nullptr);
  }

  void start_devices(const ServeOptions& options) {
    physics_.emplace(options.device);
    if (options.no_render) return;
    const int device = choose_render_device(list_devices(), options.device, options.render_device).index;
    rendering_.emplace(std::to_string(device), Purpose::rendering);
  }

  std::optional<Device> physics_, rendering_;
  std::optional<ServedWorlds> worlds_;
  std::optional<ServedScene> scene_;
};

// One client after the other; what one of them breaks off ends its own stream.
void serve_socket(Served& served, const std::string& path) {
  const Listener listener(path);
  std::fprintf(stderr, "phyvisgen: serves %s at %s\n", served.name().c_str(), path.c_str());
  while (true) {
    const OpenFile client(listener.next_client());
    try {
      served.stream(client, client);
    } catch (const DeviceError&) {
      throw;
    } catch (const Failure& failure) {
      std::fprintf(stderr, "phyvisgen: a client is gone: %s\n", failure.what());
    }
  }
}

// A client that waits for a greeting gets the reason why there is none.
void refuse_client(const std::string& sentence) {
  Message message;
  message.head["error"] = sentence;
  write_message(STDOUT_FILENO, message);
}

void run_serve(const ServeOptions& options) {
  if (options.file.empty())
    throw UsageError("serve needs a task or scene file; `phyvisgen serve --help` shows an example");
  signal(SIGPIPE, SIG_IGN);  // a client that is gone is an error of the write
  std::optional<Served> served;
  try {
    if (options.no_render) check_no_pictures(options.pictures, options.render_device);
    served.emplace(options);
  } catch (const UsageError& error) {
    if (options.socket.empty() && !isatty(STDOUT_FILENO)) refuse_client(error.what());
    throw;
  }
  if (!options.socket.empty()) return serve_socket(*served, options.socket);
  // whatever else is printed goes where messages to people go
  const OpenFile answers(dup(STDOUT_FILENO));
  dup2(STDERR_FILENO, STDOUT_FILENO);
  served->stream(STDIN_FILENO, answers);
}

}  // namespace

void add_serve(CLI::App& program) {
  CLI::App* command = program.add_subcommand("serve", "Step a task or a scene for another program, such as a policy");
  ServeOptions& o = options_of_command(*command, run_serve);
  command->add_option("FILE", o.file, "Task or scene file (YAML), or MJCF (.xml), URDF");
  command->add_option("--socket", o.socket, "Path of a socket for clients, one after the other; else standard streams");
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_option("--render-device", o.render_device,
                      "The one that renders, if another; where neither is named: a second GPU of the same kind");
  command->add_option("--width", o.pictures.width, "Width of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--height", o.pictures.height, "Height of all pictures [pixels]")->check(CLI::Range(2, 16384));
  command->add_option("--samples", o.pictures.samples, "Paths per pixel; else what the task says")
      ->check(CLI::Range(1, 1 << 20));
  command->add_option("--fps", o.pictures.frames_per_second, "Actions per second, as frames of `generate`")
      ->check(CLI::Range(0.01, 1000.0));
  command->add_option("--worlds", o.n_worlds, "So many episodes of the task, which step together in one solve")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  command->add_flag("--no-render", o.no_render, "No pictures will be asked for");
  command
      ->add_option_function<std::string>(
          "--gripper", [&o](const std::string& kind) { o.is_rigid = kind == "rigid"; },
          "soft, or rigid: the same fingers without bending, for comparison")
      ->check(CLI::IsMember({"soft", "rigid"}));
  command->add_option("--perturb", o.perturbations,
                      "NAME=NUMBER, such as friction=0.5: the task other than it says; may be repeated");
  command->footer(
      "The protocol is in docs/reference/serve.md; the Python package of pipeline/python speaks it.\n"
      "Example:\n  phyvisgen serve data/tasks/weigh_beaker.yaml --no-render --socket /tmp/beaker.sock\n"
      "  phyvisgen serve data/tasks/weigh_beaker.yaml --no-render --perturb friction=0.5\n"
      "  phyvisgen serve data/tasks/weigh_beaker.yaml --no-render --worlds 16\n"
      "  phyvisgen serve data/validation/pendulum.yaml --no-render");
}

}  // namespace pvg
