// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/bring_case.h"

#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "publish/case_place.h"
#include "publish/page_files.h"
#include "publish/refused.h"

namespace trephine::publish {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t max_manifest_bytes = std::uint64_t{16} << 20;

void copy_bytes(const fs::path& from, const fs::path& to) {
  const std::vector<char> bytes = read_file(from);
  write_file(to, {bytes.data(), bytes.size()});
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->is_regular_file() && it->path().filename().string().rfind(temporary_prefix, 0) != 0)
      all.push_back(it->path());
  return all;
}

// Files are named by their content: one that is there already in its size is the same.
void copy_named_files(const fs::path& from, const fs::path& to, const cases::CaseManifest& manifest) {
  for (const cases::CaseFile& f : manifest.files) {
    const std::vector<char> bytes = read_file(from / f.name);
    const std::string_view text(bytes.data(), bytes.size());
    if (bytes.size() != f.bytes || sha256_of_bytes(text) != f.sha256)
      throw Error(ExitCode::bad_input, f.name, "", "was damaged on this node after it was built");
    std::error_code ignored;
    if (fs::exists(to / f.name, ignored) && fs::file_size(to / f.name, ignored) == f.bytes &&
        sha256_of_file(to / f.name) == f.sha256)
      continue;
    make_output_folder((to / f.name).parent_path());
    write_file(to / f.name, text);
  }
}

// The pictures of the older case could be mistaken for those of this one.
void copy_report(const fs::path& from, const fs::path& to) {
  const std::vector<fs::path> now = files_in(from);
  if (!now.empty()) make_output_folder(to);
  for (const fs::path& file : now) copy_bytes(file, to / file.filename());
  std::error_code ignored;
  for (const fs::path& file : files_in(to))
    if (is_of_report(file) && !fs::exists(from / file.filename(), ignored)) fs::remove(file, ignored);
}

}  // namespace

void bring_case(const fs::path& from_library, const fs::path& library, const std::string& case_token) {
  const fs::path from = from_library / case_token;
  const std::vector<char> bytes = read_file(from / "case.json", max_manifest_bytes);
  const std::string_view text(bytes.data(), bytes.size());
  const cases::CaseManifest manifest = cases::parse_case_json(text);
  make_output_folder(library);
  CasePlace place(library / case_token);
  const fs::path to = place.made_in();
  for (const fs::path& f : {to, to / "meshes", to / "report"}) remove_stale_temporaries(f);
  copy_named_files(from, to, manifest);
  copy_report(from / "report", to / "report");
  copy_bytes(from / "run.json", to / "run.json");
  place.require_held();
  write_file(to / "case.json", text);
  cases::remove_unnamed_case_files(to);
  place.appear();
  remove_refused(refused_folder(library, case_token));
}

void bring_refused(const fs::path& from_library, const fs::path& library, const std::string& case_token) {
  const fs::path from = refused_folder(from_library, case_token), to = refused_folder(library, case_token);
  std::error_code error;
  if (!fs::is_directory(from, error)) return;
  const fs::path beside = library / ("." + to.filename().string());
  fs::remove_all(beside, error);
  fs::create_directory(beside, error);
  fs::permissions(beside, fs::perms::owner_all, error);
  fs::copy(from, beside, fs::copy_options::recursive, error);
  if (!error) {
    fs::remove_all(to, error);
    fs::rename(beside, to, error);
  }
  std::error_code ignored;
  if (error) fs::remove_all(beside, ignored);
}

}  // namespace trephine::publish
