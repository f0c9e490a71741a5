#include "host/base/program_pipe.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "host/base/error.hpp"

namespace pvg {

ProgramPipe::ProgramPipe(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         Direction direction, std::string what)
    : what_(std::move(what)) {
  std::vector<std::string> all = {program.string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : all) argv.push_back(argument.data());
  argv.push_back(nullptr);

  // Both ends close in other children. Sockets, as a write to one whose reader is gone can be made an error here and no
  // signal that ends the program.
  int data[2] = {-1, -1}, messages[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, data) != 0 || pipe2(messages, O_CLOEXEC) != 0) {
    if (data[0] >= 0) close(data[0]), close(data[1]);
    throw Failure(what_ + ": no pipe to " + program.string() + " could be made: " + std::strerror(errno));
  }
  const bool feeds = direction == Direction::to_program;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, data[0], feeds ? 0 : 1);
  posix_spawn_file_actions_adddup2(&actions, messages[1], 2);
  posix_spawn_file_actions_addopen(&actions, feeds ? 1 : 0, "/dev/null", feeds ? O_WRONLY : O_RDONLY, 0);
  const int code = posix_spawn(&child_, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(data[0]);
  close(messages[1]);
  data_ = data[1];
  messages_ = messages[0];
  if (code != 0) {
    child_ = -1;
    end();
    throw Failure(what_ + ": " + program.string() + " could not be started: " + std::strerror(code));
  }
}

ProgramPipe::~ProgramPipe() {
  if (child_ > 0) kill(child_, SIGKILL);
  end();
}

std::string ProgramPipe::end() {
  if (data_ >= 0) close(data_);
  data_ = -1;
  std::string said;
  char part[512];
  for (ssize_t n; messages_ >= 0 && ((n = ::read(messages_, part, sizeof part)) > 0 || (n < 0 && errno == EINTR));)
    if (n > 0) said.append(part, std::size_t(n));
  if (messages_ >= 0) close(messages_);
  messages_ = -1;
  int status = 0;
  while (child_ > 0 && waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  has_failed_ = has_failed_ || !WIFEXITED(status) || WEXITSTATUS(status) != 0;
  // the last line, which is where interpreters name the error
  while (!said.empty() && said.back() == '\n') said.pop_back();
  return said.substr(said.rfind('\n') + 1);
}

void ProgramPipe::write(const void* bytes, std::size_t n) {
  for (std::size_t done = 0; done < n;) {
    const ssize_t sent = send(data_, static_cast<const char*>(bytes) + done, n - done, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) throw Failure(what_ + ": the program that writes it ended early: " + end());
    done += std::size_t(sent);
  }
}

std::size_t ProgramPipe::read(void* bytes, std::size_t n) {
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got = recv(data_, static_cast<char*>(bytes) + done, n - done, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += std::size_t(got);
  }
  return done;
}

void ProgramPipe::finish() {
  if (data_ >= 0) shutdown(data_, SHUT_WR);
  const std::string said = end();
  if (has_failed_) throw Failure(what_ + ": " + said);
}

}  // namespace pvg
