// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/zip_bundle.h"

#include <zip.h>

#include "base/error.h"

namespace trephine::meshio {
namespace {

constexpr zip_uint16_t first_day = 1 << 5 | 1;  // of January 1980, the earliest that a ZIP archive can say

[[noreturn]] void fail(const char* step, const char* why) {
  throw Error(ExitCode::internal, "", "bundle", std::string(step) + ": " + why);
}

/// The archive in memory. It holds the source once more than the archive does, and reads it when that is closed.
class Archive {
 public:
  Archive() {
    zip_error_t error;
    zip_error_init(&error);
    source_ = zip_source_buffer_create(nullptr, 0, 0, &error);
    if (source_) zip_ = zip_open_from_source(source_, ZIP_CREATE | ZIP_TRUNCATE, &error);
    const std::string why = zip_ ? "" : zip_error_strerror(&error);
    zip_error_fini(&error);
    if (!zip_) {
      if (source_) zip_source_free(source_);
      fail("open", why.c_str());
    }
    zip_source_keep(source_);
  }
  ~Archive() {
    if (zip_) zip_discard(zip_);
    zip_source_free(source_);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  void add(const std::string& name, const std::string& bytes) {
    zip_source_t* of_bytes = zip_source_buffer(zip_, bytes.data(), bytes.size(), 0);
    const zip_int64_t at = of_bytes ? zip_file_add(zip_, name.c_str(), of_bytes, ZIP_FL_ENC_UTF_8) : -1;
    if (at < 0) {
      if (of_bytes) zip_source_free(of_bytes);
      fail("add", zip_strerror(zip_));
    }
    const auto index = zip_uint64_t(at);
    if (zip_file_set_dostime(zip_, index, 0, first_day, 0) != 0 ||
        zip_set_file_compression(zip_, index, ZIP_CM_DEFLATE, 1) != 0 ||
        zip_file_set_external_attributes(zip_, index, 0, ZIP_OPSYS_UNIX, zip_uint32_t{0100644} << 16) != 0)
      fail("add", zip_strerror(zip_));
  }

  std::string take() {
    if (zip_close(zip_) != 0) fail("close", zip_strerror(zip_));
    zip_ = nullptr;
    zip_stat_t stat;
    if (zip_source_stat(source_, &stat) != 0 || zip_source_open(source_) != 0) fail("read", "the archive is lost");
    std::string out(stat.size, '\0');
    const zip_int64_t read = zip_source_read(source_, out.data(), out.size());
    zip_source_close(source_);
    if (read < 0 || zip_uint64_t(read) != stat.size) fail("read", "the archive is cut off");
    return out;
  }

 private:
  zip_source_t* source_ = nullptr;
  zip_t* zip_ = nullptr;
};

}  // namespace

std::string bundle_of(const std::string& folder, const std::vector<ExportFile>& files) {
  Archive archive;
  for (const meshio::ExportFile& f : files) archive.add(folder.empty() ? f.name : folder + "/" + f.name, f.bytes);
  return archive.take();
}

}  // namespace trephine::meshio
