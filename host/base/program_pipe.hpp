// A program that is fed or read through a pipe. What it says on stderr becomes the error's text.
#pragma once
#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

class ProgramPipe {
 public:
  enum class Direction { to_program, from_program };
  // arguments: without the program's own name; `what` names the work in errors, such as a file
  ProgramPipe(const std::filesystem::path& program, const std::vector<std::string>& arguments, Direction direction,
              std::string what);
  ~ProgramPipe();  // without finish(): the program is stopped
  ProgramPipe(const ProgramPipe&) = delete;

  void write(const void* bytes, std::size_t n);
  std::size_t read(void* bytes, std::size_t n);  // fewer than n: the program has no more
  void finish();                                 // waits for its end; a Failure where it is not 0

 private:
  std::string end();
  std::string what_;
  int data_ = -1, messages_ = -1;  // file descriptors
  pid_t child_ = -1;
  bool has_failed_ = false;
};

}  // namespace pvg
