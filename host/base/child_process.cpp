#include "host/base/child_process.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr int PIPE_SIZE = 1 << 20;  // [bytes]: the larger, the less often the two wait for each other

// first byte of what the child says
constexpr char DONE = 'd', REFUSED = 'r', FAILED = 'f';

void write_all(int file, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = write(file, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno != EINTR) return;
    if (n > 0) at += std::size_t(n);
  }
}

std::string read_all(int file) {
  std::string bytes;
  std::vector<char> chunk(PIPE_SIZE);
  for (;;) {
    const ssize_t n = read(file, chunk.data(), chunk.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return bytes;
    bytes.append(chunk.data(), std::size_t(n));
  }
}

rlim_t memory_now() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * rlim_t(sysconf(_SC_PAGESIZE));
}

// assimp's reader of OBJ takes 16 MB for a file of any size. Four thousand page faults for them were two thirds of the
// time that such a file took; where the system lends large pages, they are sixteen.
void take_memory_in_large_pages() {
  constexpr std::size_t BYTES = std::size_t(32) << 20, LARGE_PAGE = std::size_t(2) << 20;
  mallopt(M_MMAP_THRESHOLD, 2 * BYTES);  // what is taken next comes from the heap,
  mallopt(M_TRIM_THRESHOLD, 4 * BYTES);  // which keeps it for the reader
  void* const memory = std::malloc(BYTES);
  const std::uintptr_t first = (reinterpret_cast<std::uintptr_t>(memory) + LARGE_PAGE - 1) / LARGE_PAGE * LARGE_PAGE;
  if (memory) madvise(reinterpret_cast<void*>(first), BYTES - LARGE_PAGE, MADV_HUGEPAGE);  // refused, it takes longer
  std::free(memory);
}

[[noreturn]] void be_child(int out, const ProcessLimits& limits, const std::function<std::string()>& work) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGXCPU})
    std::signal(signal, SIG_DFL);
  sigset_t none;  // the parent may have some of them blocked
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const rlim_t most_memory = memory_now() + limits.bytes;
  const rlimit seconds{limits.seconds, limits.seconds}, memory{most_memory, most_memory}, no_core{0, 0};
  setrlimit(RLIMIT_CPU, &seconds);
  setrlimit(RLIMIT_AS, &memory);
  setrlimit(RLIMIT_CORE, &no_core);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  take_memory_in_large_pages();
  std::string said;
  try {
    said = DONE + work();
  } catch (const UsageError& error) {
    said = std::string(1, REFUSED) + error.what();
  } catch (...) {
    said = FAILED;
  }
  write_all(out, said);
  _exit(0);
}

}  // namespace

std::string in_child_process(const std::string& what, const ProcessLimits& limits,
                             const std::function<std::string()>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Failure(what + ": no pipe could be made; close other programs.");
  fcntl(ends[1], F_SETPIPE_SZ, PIPE_SIZE);  // refused, it only takes longer
  std::fflush(nullptr);                     // what is not yet written would be written by the child, too
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]), close(ends[1]);
    throw Failure(what + ": no process could be started; close other programs.");
  }
  if (child == 0) be_child(ends[1], limits, work);
  close(ends[1]);
  const std::string said = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool has_ended = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !said.empty();
  if (has_ended && said[0] == REFUSED) throw UsageError(said.substr(1));
  if (!has_ended || said[0] != DONE)
    throw UsageError(what + " cannot be read: its reader broke down over it. The file is damaged; export it again.");
  return said.substr(1);
}

}  // namespace pvg
