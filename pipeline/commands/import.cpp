// phyvisgen import: an MJCF or URDF file as a scene file.
#include <cstdio>
#include <filesystem>

#include "host/base/atomic_files.hpp"
#include "host/base/outputs.hpp"
#include "host/load/scene_file.hpp"
#include "host/robot/imported_scene.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

struct ImportOptions {
  std::string model, file;
};

void run_import(const ImportOptions& options) {
  if (options.model.empty() || options.file.empty())
    throw UsageError("import needs a model and an output file; `phyvisgen import --help` shows an example");
  if (!is_robot_description(options.model))
    throw UsageError(options.model + " is neither MJCF (.xml, .mjcf) nor URDF (.urdf); give one of these");
  load_scene_run(options.model);  // what cannot be simulated is not written
  check_output_file(options.file, {".yaml", ".yml"});
  const std::filesystem::path file = std::filesystem::absolute(options.file);
  write_text_atomically(file, imported_scene(options.model, file.parent_path()));
  std::printf("%s\n", options.file.c_str());
}

}  // namespace

void add_import(CLI::App& program) {
  CLI::App* command = program.add_subcommand("import", "Write an MJCF or URDF file as a scene file");
  ImportOptions& o = options_of_command(*command, run_import);
  command->add_option("MODEL", o.model, "MJCF (.xml, .mjcf) or URDF (.urdf)");
  command->add_option("-o,--output", o.file, "Scene file (YAML) to write");
  command->footer("Example:\n  phyvisgen import data/robots/fr3/fr3.urdf -o fr3.yaml");
}

}  // namespace pvg
