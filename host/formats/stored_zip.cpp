#include "host/formats/stored_zip.hpp"

#include <archive.h>
#include <archive_entry.h>

#include "host/base/error.hpp"

namespace pvg {
namespace {
constexpr std::time_t FIRST_OF_1980 = 315532800;  // a zip knows no earlier time
}

StoredZip::StoredZip(const std::filesystem::path& path) : path_(path), archive_(archive_write_new()) {
  demand(archive_write_set_format_zip(archive_) == ARCHIVE_OK &&
         archive_write_zip_set_compression_store(archive_) == ARCHIVE_OK &&
         archive_write_open_filename(archive_, path.c_str()) == ARCHIVE_OK);
}

StoredZip::~StoredZip() {
  if (archive_) archive_write_free(archive_);
}

void StoredZip::demand(bool ok) const {
  if (ok) return;
  const char* said = archive_error_string(archive_);
  throw Failure(path_.string() + " could not be written: " + (said ? said : "unknown reason"));
}

void StoredZip::add(const std::string& name, const void* bytes, std::size_t n) {
  const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(), archive_entry_free);
  archive_entry_set_pathname(entry.get(), name.c_str());
  archive_entry_set_size(entry.get(), std::int64_t(n));
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_mtime(entry.get(), FIRST_OF_1980, 0);
  demand(archive_write_header(archive_, entry.get()) == ARCHIVE_OK);
  demand(n == 0 || archive_write_data(archive_, bytes, n) == la_ssize_t(n));
}

void StoredZip::close() { demand(archive_write_close(archive_) == ARCHIVE_OK); }

}  // namespace pvg
