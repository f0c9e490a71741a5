// Where a command may write: never onto a file that it reads, nor into or around a folder that it reads. Loaders say
// what they read; outputs are checked before the work begins.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

// Whether there is a file of this name; a link that leads nowhere, or to itself, is none.
bool is_file(const std::filesystem::path& file);

// From now on `file` is an input of this process, by whatever name or link it is called.
void remember_read(const std::filesystem::path& file);

// A UsageError where `output` is a file that was read.
void check_is_not_read(const std::filesystem::path& output);

// A UsageError where no file can be made of this name: it was read, it is a folder or a device, its folder is not there
// or cannot be written to, or it has none of the endings (empty: any).
void check_output_file(const std::filesystem::path& output, const std::vector<std::string>& endings = {},
                       const std::string& option = "-o");

// A UsageError where no folder can be made of this name, or where one stands there that holds anything else than
// `ours`, the names of what `what` writes, with * and ?: replacing it would lose that.
void check_output_folder(const std::filesystem::path& output, const std::vector<std::string>& ours,
                         const std::string& what);

// A UsageError where `output` is `input` or lies in it. what: the command does, such as "merge".
void check_not_within(const std::filesystem::path& output, const std::filesystem::path& input, const std::string& what);
// Likewise, also where it lies around it.
void check_apart(const std::filesystem::path& output, const std::filesystem::path& input, const std::string& what);

}  // namespace pvg
