// The device layer: buffers keep what they are given, launches check their arguments, failures say what was done.
#include "host/device/device.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace pvg {
namespace {

const char* const doubling =
    "kernel void twice(const uint n, global const double* x, global double* y) {\n"
    "  const uint i = get_global_id(0); if (i >= n) return; y[i] = 2 * x[i]; }\n";

TEST(Device, KernelReachesEveryElementForAwkwardSizes) {
  Device device;
  Program program = Program::from_text(device, "twice", doubling);
  Kernel twice = program.kernel("twice");
  for (const std::size_t n : {0, 1, 3, 257, 1000}) {
    std::vector<double> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = double(i) + 0.25;
    Buffer<double> x(device, values, "x"), y(device, n, "y");
    twice(n, unsigned(n), x, y);
    const std::vector<double> doubled = y.read();
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(doubled[i], 2 * values[i]);
  }
}

// Both where the device runs host functions and where the numbers travel.
TEST(Device, AHostFunctionIsCalledInTheOrderOfTheQueue) {
  for (const char* runs : {"1", "0"}) {
    setenv("PVG_HOST_FUNCTIONS", runs, 1);
    Device device;
    unsetenv("PVG_HOST_FUNCTIONS");
    EXPECT_FALSE(*runs == '0' && device.info().runs_host_functions);
    Program program = Program::from_text(device, "twice", doubling);
    Kernel twice = program.kernel("twice");
    // not in the order in which they are used
    Buffer<double> z(device, 3, "z"), y(device, 3, "y"), x(device, std::vector<double>{1, 2, 3}, "x");
    const DeviceCounts before = device.counts();
    twice(3, 3u, x, y);
    device.call({reads(y), writes(z)}, [](std::span<void* const> memory) {
      for (int i = 0; i < 3; ++i) static_cast<double*>(memory[1])[i] = static_cast<double*>(memory[0])[i] + 0.5;
    });
    twice(3, 3u, z, y);
    const DeviceCounts counts = device.counts() - before;
    EXPECT_EQ(y.read(), (std::vector<double>{5, 9, 13})) << "2 (2 x + 0.5)";
    EXPECT_EQ(counts.launches, device.info().runs_host_functions ? 3u : 2u);
    EXPECT_EQ(counts.waits, device.info().runs_host_functions ? 0u : 1u);
    EXPECT_EQ(counts.bytes, device.info().runs_host_functions ? 0u : 2 * 3 * sizeof(double));
  }
}

TEST(Device, CountsWhatItIsAskedFor) {
  Device device;
  Program program = Program::from_text(device, "twice", doubling);
  Kernel twice = program.kernel("twice");
  Buffer<double> x(device, 5, "x"), y(device, 5, "y");
  const DeviceCounts before = device.counts();
  x.zero();
  x.write(std::vector<double>(5, 1.0));
  twice(5, 5u, x, y);
  twice(0, 0u, x, y);  // starts nothing
  x.copy_from(y);
  std::vector<double> values(5);
  x.read_later(0, std::span(values));
  device.finish();
  const DeviceCounts counts = device.counts() - before;
  EXPECT_EQ(values, std::vector<double>(5, 2.0));
  EXPECT_EQ(counts.launches, 3u);
  EXPECT_EQ(counts.writes, 1u);
  EXPECT_EQ(counts.waits, 1u);
  EXPECT_EQ(counts.bytes, 2 * 5 * sizeof(double));
}

TEST(Device, WrongNumberOfArgumentsNamesTheKernel) {
  Device device;
  Program program = Program::from_text(device, "twice", doubling);
  Kernel twice = program.kernel("twice");
  Buffer<double> x(device, 1, "x");
  try {
    twice(1, 1u, x);
    FAIL() << "a missing argument was accepted";
  } catch (const std::logic_error& e) {
    EXPECT_NE(std::string(e.what()).find("twice takes 3 arguments, was given 2"), std::string::npos) << e.what();
  }
}

TEST(Device, SwappedBuffersAreNamed) {
  Device device;
  Program program = Program::from_text(device, "twice", doubling);
  Kernel twice = program.kernel("twice");
  Buffer<double> x(device, 1, "x"), y(device, 1, "y"), force(device, 1, "force");
  try {
    twice(1, 1u, y, x);
    FAIL() << "swapped buffers were accepted";
  } catch (const std::logic_error& e) {
    EXPECT_STREQ(e.what(), "kernel twice: argument x was given buffer y, and y buffer x");
  }
  EXPECT_NO_THROW(twice(1, 1u, force, y));
}

TEST(Device, BrokenKernelNamesFileAndLine) {
  if (std::getenv("PVG_OCLGRIND")) GTEST_SKIP() << "Oclgrind's compiler names its own file and line";
  Device device;
  try {
    Program::from_text(device, "broken.cl", "kernel void f() {\n  nonsense;\n}\n");
    FAIL() << "nonsense was built";
  } catch (const DeviceError& e) {
    EXPECT_NE(std::string(e.what()).find("broken.cl"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find(":2:"), std::string::npos) << e.what();
  }
}

TEST(Device, UnknownDeviceIsAUsageError) { EXPECT_THROW(Device("no such device"), UsageError); }

TEST(Device, BufferRefusesAWrongLength) {
  Device device;
  Buffer<double> x(device, 3, "x");
  EXPECT_THROW(x.write(std::vector<double>(4)), std::logic_error);
  EXPECT_THROW(x.read(2, 2), std::logic_error);
}

TEST(Memory, WhatTheDeviceHasNoRoomForIsToldWithItsSize) {
  Device device;
  try {
    Buffer<double> too_large(device, std::size_t(1) << 50, "a petabyte");
    FAIL() << "allocated";
  } catch (const OutOfDeviceMemory& error) {
    EXPECT_NE(std::string(error.what()).find("a petabyte, 9007199254740992 bytes"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace pvg
