#include "host/base/program_pipe.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr std::size_t MOST_SAID = 1 << 16;  // of messages that are kept, twice as many at most [bytes]

}  // namespace

ProgramPipe::ProgramPipe(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         Direction direction, std::string what)
    : what_(std::move(what)) {
  // Both ends close in other children. Sockets, as a write to one whose reader is gone can be made an error here and no
  // signal that ends the program.
  int data[2] = {-1, -1}, messages[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, data) != 0 || pipe2(messages, O_CLOEXEC) != 0) {
    if (data[0] >= 0) close(data[0]), close(data[1]);
    throw Failure(what_ + ": no pipe to " + program.string() + " could be made: " + std::strerror(errno));
  }
  const bool feeds = direction == Direction::to_program;
  data_ = data[1];
  messages_ = messages[0];
  try {
    child_.emplace(program, arguments, ChildProgram::Files{feeds ? data[0] : -1, feeds ? -1 : data[0], messages[1]},
                   ChildProgram::Signals::own);
  } catch (const Failure& failure) {
    close(data[0]);
    close(messages[1]);
    end();
    throw Failure(what_ + ": " + failure.what());
  }
  close(data[0]);
  close(messages[1]);
}

ProgramPipe::~ProgramPipe() {
  child_.reset();
  end();
}

void ProgramPipe::take_messages() {
  char part[512];
  const ssize_t n = ::read(messages_, part, sizeof part);
  if (n < 0 && errno == EINTR) return;
  if (n > 0) said_.append(part, std::size_t(n));
  if (said_.size() > 2 * MOST_SAID) said_.erase(0, said_.size() - MOST_SAID);
  if (n > 0) return;
  close(messages_);
  messages_ = -1;
}

// A program whose messages nobody takes waits once their pipe is full, and neither gives nor takes more.
void ProgramPipe::wait_for(short event) {
  for (;;) {
    pollfd files[] = {{data_, event, 0}, {messages_, POLLIN, 0}};  // of -1 nothing is asked
    if (poll(files, 2, -1) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    if (files[1].revents) take_messages();
    if (files[0].revents) return;
  }
}

std::string ProgramPipe::end() {
  if (data_ >= 0) close(data_);
  data_ = -1;
  while (messages_ >= 0) take_messages();
  has_failed_ = has_failed_ || (child_ && child_->wait() != 0);
  child_.reset();
  // the last line, which is where interpreters name the error
  while (!said_.empty() && said_.back() == '\n') said_.pop_back();
  return said_.substr(said_.rfind('\n') + 1);
}

void ProgramPipe::write(const void* bytes, std::size_t n) {
  for (std::size_t done = 0; done < n;) {
    const ssize_t sent = send(data_, static_cast<const char*>(bytes) + done, n - done, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) {
      wait_for(POLLOUT);
      continue;
    }
    if (sent < 0) throw Failure(what_ + ": the program that writes it ended early: " + end());
    done += std::size_t(sent);
  }
}

std::size_t ProgramPipe::read(void* bytes, std::size_t n) {
  std::size_t done = 0;
  while (done < n) {
    const ssize_t got = recv(data_, static_cast<char*>(bytes) + done, n - done, MSG_DONTWAIT);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) {
      wait_for(POLLIN);
      continue;
    }
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
