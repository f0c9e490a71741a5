// The three ways in which the program can fail, each with its exit code. A message is one sentence that names the file,
// key, body or joint, and says what to do. Thrown where it is noticed, caught once, in main.
#pragma once
#include <stdexcept>
#include <string>

namespace pvg {

// Something could not be done: exit code 1.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The input is wrong (a file, a key, a value, an option): exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Stopped before the end, what was finished stays, calling again continues: exit code 75.
struct TryAgain : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A call of the device's driver failed: exit code 1.
struct DeviceError : Failure {
  using Failure::Failure;
};

// A buffer that the device has no room for.
struct OutOfDeviceMemory : DeviceError {
  using DeviceError::DeviceError;
};

}  // namespace pvg
