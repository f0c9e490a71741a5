#include "host/dataset/formats.hpp"

#include "host/base/error.hpp"
#include "host/dataset/act_files.hpp"
#include "host/dataset/lerobot_dataset.hpp"
#include "host/dataset/robomimic_file.hpp"
#include "host/dataset/umi_zarr.hpp"

namespace pvg {
namespace {

using AnyWriter = std::unique_ptr<DataSetWriter>;

AnyWriter make_lerobot(const PackRequest& request, LeRobotVersion version) {
  return make_lerobot_writer(request.folder, {version, request.instruction, request.origin, request.has_environment},
                             [&tables = request.tables()](const ParquetTable& table) { tables.write(table); });
}

constexpr DataSetFormat FORMATS[] = {
    {"lerobot", "LeRobot 3.0", true,
     [](const PackRequest& r) -> AnyWriter { return make_lerobot(r, LeRobotVersion::v3_0); }},
    {"lerobot2", "LeRobot 2.1", true,
     [](const PackRequest& r) -> AnyWriter { return make_lerobot(r, LeRobotVersion::v2_1); }},
    {"act", "ACT and ALOHA, HDF5", false,
     [](const PackRequest& r) -> AnyWriter { return make_act_writer(r.folder, r.set.most_frames); }},
    {"robomimic", "robomimic and MimicGen, HDF5", false,
     [](const PackRequest& r) -> AnyWriter { return make_robomimic_writer(r.folder, r.set); }},
    {"zarr", "UMI and Diffusion Policy, zipped zarr", false,
     [](const PackRequest& r) -> AnyWriter { return make_umi_zarr_writer(r.folder); }},
};

}  // namespace

std::span<const DataSetFormat> data_set_formats() { return FORMATS; }

const DataSetFormat& data_set_format(const std::string& name) {
  std::string names;
  for (const DataSetFormat& format : FORMATS) {
    if (name == format.name) return format;
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw UsageError("--format " + name + " is not one of " + names);
}

}  // namespace pvg
