// A zip whose files are stored as they are (by libarchive). The same files in the same order give the same bytes.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

struct archive;

namespace pvg {

class StoredZip {
 public:
  explicit StoredZip(const std::filesystem::path& path);
  ~StoredZip();
  StoredZip(const StoredZip&) = delete;
  void add(const std::string& name, const void* bytes, std::size_t n);
  void add(const std::string& name, const std::string& text) { add(name, text.data(), text.size()); }
  void close();  // throws if something could not be written

 private:
  void demand(bool ok) const;
  std::filesystem::path path_;
  archive* archive_;
};

}  // namespace pvg
