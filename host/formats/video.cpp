#include "host/formats/video.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <vector>

namespace pvg {
namespace {

void demand(bool ok, const char* what) {
  if (!ok) throw Failure(std::string(what) + " to ffmpeg could not be opened: " + std::strerror(errno));
}

std::vector<std::string> ffmpeg_arguments(const std::filesystem::path& path, int width, int height, double rate) {
  char rate_text[32];
  std::snprintf(rate_text, sizeof rate_text, "%.12g", rate);
  return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-y",
          // what comes in
          "-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size", std::to_string(width) + "x" + std::to_string(height),
          "-framerate", rate_text, "-i", "pipe:0",
          // sRGB to the colours of HD video, exactly rounded; the file says so
          "-vf", "scale=flags=accurate_rnd+full_chroma_int+bitexact:out_color_matrix=bt709:out_range=tv", "-pix_fmt",
          "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv",
          // one thread and no version texts: the same bytes from the same frames
          "-c:v", "libx264", "-preset", "medium", "-crf", "18", "-bf", "0", "-g", "10", "-threads", "1", "-fflags",
          "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1", "-movflags", "+faststart", "-f", "mp4",
          // a path that begins with a dash is no option
          "file:" + path.string()};
}

}  // namespace

std::filesystem::path find_program(const std::string& program, const std::string& package) {
  const char* folders = std::getenv("PATH");
  std::istringstream list(folders ? folders : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    const std::filesystem::path path = std::filesystem::path(folder.empty() ? "." : folder) / program;
    std::error_code ignored;
    if (access(path.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(path, ignored)) return path;
  }
  throw UsageError("the program " + program + " was not found on PATH; install it (Debian package " + package + ")");
}

VideoWriter::VideoWriter(const std::filesystem::path& path, int width, int height, double rate)
    : path_(path), frame_bytes_(std::size_t(width) * std::size_t(height) * 3) {
  if (width <= 0 || height <= 0 || width % 2 || height % 2)
    throw UsageError(path.string() + ": a video needs an even width and height, not " + std::to_string(width) + " x " +
                     std::to_string(height));
  if (!(rate > 0)) throw UsageError(path.string() + ": a video needs a positive rate of frames");
  const std::filesystem::path program = find_program("ffmpeg", "ffmpeg");
  const std::vector<std::string> arguments = ffmpeg_arguments(path, width, height, rate);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  // Both ends close in other children. A pair of sockets, as a write to one whose reader is gone can be made an error
  // here and no signal that ends the program.
  int frames[2], messages[2];
  demand(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, frames) == 0, "the way");
  frames_ = frames[1];
  demand(pipe2(messages, O_CLOEXEC) == 0, "the way back from");
  messages_ = messages[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, frames[0], 0);
  posix_spawn_file_actions_adddup2(&actions, messages[1], 2);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  // a group of its own: Ctrl-C is for us to handle
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setpgroup(&attributes, 0);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  const int code = posix_spawn(&child_, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(frames[0]);
  close(messages[1]);
  if (code != 0) {
    child_ = -1;
    end();
    throw Failure(program.string() + " could not be started: " + std::strerror(code));
  }
}

VideoWriter::~VideoWriter() {
  if (child_ > 0) kill(child_, SIGKILL);
  end();
}

std::string VideoWriter::end() {
  if (frames_ >= 0) close(frames_);
  frames_ = -1;
  std::string said;
  char part[512];
  for (ssize_t n; messages_ >= 0 && ((n = read(messages_, part, sizeof part)) > 0 || (n < 0 && errno == EINTR));)
    if (n > 0 && said.size() < 1000) said.append(part, std::size_t(n));
  if (messages_ >= 0) close(messages_);
  messages_ = -1;
  int status = 0;
  while (child_ > 0 && waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  has_failed_ = has_failed_ || !WIFEXITED(status) || WEXITSTATUS(status) != 0;
  return said.substr(0, said.find('\n'));
}

void VideoWriter::write(std::span<const std::uint8_t> rgb) {
  if (rgb.size() != frame_bytes_) throw Failure(path_.string() + ": a frame of another size was given to the video");
  for (std::size_t done = 0; done < rgb.size();) {
    const ssize_t n = send(frames_, rgb.data() + done, rgb.size() - done, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Failure(path_.string() + ": ffmpeg ended early: " + end());
    done += std::size_t(n);
  }
}

void VideoWriter::finish() {
  const std::string said = end();
  if (has_failed_) throw Failure(path_.string() + ": ffmpeg could not write the video: " + said);
}

}  // namespace pvg
