// While one lives, what libraries print on stderr of their own accord (libpng does) goes nowhere: the program says in
// its own sentence what is wrong. Short, for reads: other threads are unheard meanwhile.
#pragma once

namespace pvg {

class QuietLibraries {
 public:
  QuietLibraries();
  ~QuietLibraries();
  QuietLibraries(const QuietLibraries&) = delete;

 private:
  int kept_ = -1;  // file descriptor of stderr
};

}  // namespace pvg
