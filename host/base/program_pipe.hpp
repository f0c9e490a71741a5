// A program that is fed or read through a pipe. What it says on stderr becomes the error's text.
#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/child_program.hpp"

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
  void wait_for(short event);  // of data_, as of poll(); takes messages meanwhile
  void take_messages();
  std::string what_, said_;        // said_: the end of its messages so far
  int data_ = -1, messages_ = -1;  // file descriptors
  std::optional<ChildProgram> child_;
  bool has_failed_ = false;
};

}  // namespace pvg
