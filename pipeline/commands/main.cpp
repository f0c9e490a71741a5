// phyvisgen: every error is one sentence on stderr and an exit code.
#include <malloc.h>

#include <cstdio>
#include <exception>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "pipeline/command_line/command_line.hpp"
#include "pipeline/command_line/program.hpp"

namespace {

// exit codes; 75 is EX_TEMPFAIL of sysexits.h, which batch systems read as "queue me again"
constexpr int DONE = 0, FAILED = 1, WRONG_USE = 2, TRY_AGAIN = 75;

int report(const std::string& message, int code) {
  std::fprintf(stderr, "phyvisgen: %s\n", pvg::with_final_names(message).c_str());
  return code;
}

// What was freed is kept for the next step or picture: to ask the system anew, page by page, takes 5 to 8 % of the
// time of a towel's step. Where the library has no such choice nothing changes.
void keep_freed_memory() {
#ifdef M_MMAP_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  try {
    pvg::run_command_line(pvg::all_commands(), {argv + 1, argv + argc});
    return DONE;
  } catch (const pvg::UsageError& error) {
    return report(error.what(), WRONG_USE);
  } catch (const pvg::TryAgain& error) {
    return report(error.what(), TRY_AGAIN);
  } catch (const pvg::Failure& error) {
    return report(error.what(), FAILED);
  } catch (const std::exception& error) {
    return report(pvg::sentence_of(error), FAILED);
  }
}
