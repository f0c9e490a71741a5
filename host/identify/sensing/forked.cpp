#include "host/identify/sensing/forked.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/stop_signal.hpp"

namespace pvg::diagnose {
namespace {

constexpr int LOOK_EVERY = 100;                 // at the signals [ms]
enum class Outcome : char { returned, threw };  // the first byte that comes back

void write_all(int file, const std::vector<char>& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = write(file, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno != EINTR) return;  // nobody reads any more
    at += n > 0 ? std::size_t(n) : 0;
  }
}

std::vector<char> read_all(int file, Clock::time_point deadline) {
  std::vector<char> bytes, part(1 << 16);
  for (;;) {
    pollfd waiting{file, POLLIN, 0};
    while (poll(&waiting, 1, LOOK_EVERY) == 0) {
      if (stop_on_signals()) throw TryAgain("stopped while another process simulated; call again to continue");
      if (Clock::now() > deadline) throw OutOfTime();
    }
    const ssize_t n = read(file, part.data(), part.size());
    if (n == 0 || (n < 0 && errno != EINTR)) return bytes;
    bytes.insert(bytes.end(), part.begin(), part.begin() + std::max<ssize_t>(n, 0));
  }
}

std::vector<char> outcome_of(const std::function<std::vector<char>()>& work) {
  const auto message = [](Outcome outcome, const auto& content) {
    std::vector<char> bytes = {char(outcome)};
    bytes.insert(bytes.end(), content.begin(), content.end());
    return bytes;
  };
  try {
    return message(Outcome::returned, work());
  } catch (const std::exception& failure) {
    return message(Outcome::threw, std::string(failure.what()));
  }
}

}  // namespace

Forked::Forked(const std::function<std::vector<char>()>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw Failure(std::string("no pipe to another process: ") + std::strerror(errno));
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) {
    const int reason = errno;
    close(ends[0]), close(ends[1]);
    throw Failure(std::string("no other process could be started: ") + std::strerror(reason));
  }
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // other signals are blocked, and whoever heard them is not here
    if (getppid() != parent) _exit(1);
    close(ends[0]);
    write_all(ends[1], outcome_of(work));
    _exit(0);
  }
  close(ends[1]);
  pipe_ = ends[0];
}

Forked::Forked(Forked&& other) noexcept
    : process_(std::exchange(other.process_, -1)), pipe_(std::exchange(other.pipe_, -1)) {}

Forked::~Forked() {
  if (pipe_ >= 0) close(pipe_);
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

std::vector<char> Forked::result(Clock::time_point deadline) {
  std::vector<char> bytes = read_all(pipe_, deadline);
  int status = 0;
  waitpid(std::exchange(process_, -1), &status, 0);
  if (bytes.empty() || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Failure("a process that simulated windows was ended" +
                  (WIFSIGNALED(status) ? " by signal " + std::to_string(WTERMSIG(status)) : std::string()) +
                  "; was there too little memory? `--jobs 1` takes less");
  const bool threw = bytes.front() == char(Outcome::threw);
  bytes.erase(bytes.begin());
  if (threw) throw Failure(std::string(bytes.begin(), bytes.end()));
  return bytes;
}

}  // namespace pvg::diagnose
