// The choice of a device: the default, every way to name one, and the sentences where none will do.
#include "host/device/choose_device.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

DeviceInfo device(std::size_t index, const std::string& name, bool is_gpu, bool has_fp64) {
  DeviceInfo info;
  info.index = index;
  info.name = name;
  info.platform = is_gpu ? "Graphics Inc." : "Portable Computing Language";
  info.is_gpu = is_gpu;
  info.has_fp64 = has_fp64;
  return info;
}

const std::vector<DeviceInfo> machine = {device(0, "pthread-haswell", false, true),
                                         device(1, "Integrated 600", true, false), device(2, "Tesla 9", true, true)};

std::string complaint(const std::vector<DeviceInfo>& devices, const std::string& which) {
  try {
    choose_device(devices, which);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "none";
}

TEST(ChooseDevice, TheDefaultIsTheFirstGpuWithDoublePrecisionElseTheFirstDevice) {
  EXPECT_EQ(choose_device(machine, "").index, 2u);
  EXPECT_EQ(choose_device({machine[0], machine[1]}, "").index, 0u);
}

TEST(ChooseDevice, ADeviceIsNamedByIndexKindOrPartOfItsName) {
  EXPECT_EQ(choose_device(machine, "0").index, 0u);
  EXPECT_EQ(choose_device(machine, "cpu").index, 0u);
  EXPECT_EQ(choose_device(machine, "tesla").index, 2u);
  EXPECT_EQ(choose_device(machine, "portable").index, 0u);
}

TEST(ChooseDevice, ADeviceWithoutDoublePrecisionIsRefusedByName) {
  EXPECT_EQ(complaint(machine, "1"),
            "device Integrated 600 has no double precision (cl_khr_fp64), which the contact solver needs; choose "
            "another with --device");
  EXPECT_NE(complaint({machine[1]}, "").find("no double precision"), std::string::npos);
}

TEST(ChooseDevice, RenderingTakesADeviceWithoutDoublePrecision) {
  EXPECT_EQ(choose_device(machine, "1", Purpose::rendering).index, 1u);
  EXPECT_EQ(choose_device({machine[0], machine[1]}, "", Purpose::rendering).index, 1u) << "a GPU before a CPU";
  EXPECT_EQ(choose_device(machine, "", Purpose::rendering).index, 2u) << "the one that can do more";
  EXPECT_EQ(choose_render_device(machine, "", "1").index, 1u);
  EXPECT_EQ(choose_render_device({machine[0], machine[1]}, "", "").index, 1u) << "beside a CPU that simulates";
  EXPECT_EQ(choose_render_device({machine[0], machine[1]}, "cpu", "").index, 0u) << "who names one gets that one";
}

TEST(ChooseDevice, ASecondGpuOfTheSameKindRendersWhereNoneIsNamed) {
  std::vector<DeviceInfo> node = machine;
  EXPECT_EQ(choose_render_device(node, "", "").index, 2u) << "alone";
  node.push_back(device(3, "Tesla 9", true, true));
  EXPECT_EQ(choose_render_device(node, "", "").index, 3u);
  EXPECT_EQ(choose_render_device(node, "2", "").index, 2u) << "who names one gets that one";
  EXPECT_EQ(choose_render_device(node, "", "cpu").index, 0u);
  node[3].driver = "another";
  EXPECT_EQ(choose_render_device(node, "", "").index, 2u) << "its bits may differ";
}

TEST(ChooseDevice, NoDeviceAndNoFitAreSaidInASentence) {
  EXPECT_NE(complaint({}, "").find("no OpenCL device was found: install a driver"), std::string::npos);
  EXPECT_EQ(complaint(machine, "7"), "--device 7 fits none of the 3 OpenCL devices; `phyvisgen devices` lists them");
  try {
    choose_render_device(machine, "", "7");
    FAIL() << "there is no device 7";
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).find("--render-device 7 fits none"), 0u) << error.what();
  }
}

}  // namespace
}  // namespace pvg
