// A program that runs beside this one: every program is started here.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

class ChildProgram {
 public:
  struct Files {
    int input = -1, output = -1, messages = -1;  // descriptors that become its 0, 1, 2; -1: /dev/null
  };
  enum class Signals {
    shared,  // Ctrl-C reaches it as well
    own,     // Ctrl-C is for us to handle
  };
  // program: a path, or a name that is looked for on PATH. A Failure says why it could not be started.
  ChildProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments, const Files& files,
               Signals signals);
  ~ChildProgram();  // without wait(): it is stopped
  ChildProgram(const ChildProgram&) = delete;

  int wait();  // until it ends; its exit code, -1 where a signal ended it

 private:
  pid_t child_ = -1;
};

}  // namespace pvg
