// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/dropped.h"

#include <algorithm>
#include <chrono>
#include <string>

#include "base/write_file.h"
#include "library/library_config.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t digits = 16;

bool has_digits(const std::string& name) {
  return name.size() >= digits && name.find_first_not_of("0123456789abcdef") >= digits;
}

bool is_drop(const std::string& name) {
  return name.rfind(incoming_prefix, 0) == 0 ||
         (has_digits(name) && (name.size() == digits || name.substr(digits) == ".zip"));
}

// Whatever the texts beside LIBRARY.yaml say of it: a configuration may name a scan that LIBRARY.yaml does not.
std::string texts_beside(const fs::path& library_file) {
  std::string all;
  for (const auto& entry : fs::directory_iterator(library_file.parent_path())) {
    if (entry.path().extension() != ".yaml" && entry.path().extension() != ".yml") continue;
    const std::vector<char> bytes = read_file(entry.path(), 1 << 24);
    all.append(bytes.begin(), bytes.end());
  }
  return all;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

double seconds_since_change(const fs::path& path) {
  std::error_code error;
  const auto written = fs::last_write_time(path, error);
  return error ? 0 : std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

}  // namespace

std::vector<fs::path> unused_drops(const fs::path& library_file, const std::vector<fs::path>& roots,
                                   double older_than_s) {
  const fs::path file = fs::absolute(library_file).lexically_normal(), folder = file.parent_path() / dropped_folder;
  std::vector<fs::path> unused;
  std::error_code error;
  if (fs::is_symlink(folder, error) || !fs::is_directory(folder, error)) return unused;
  const LibraryConfig config = read_library_config(file, {{}, {}, roots});
  const std::string texts = texts_beside(file);
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!is_drop(name) || seconds_since_change(entry.path()) <= older_than_s) continue;
    const bool used = std::any_of(config.cases.begin(), config.cases.end(), [&](const LibraryCase& c) {
      return !c.series.empty() && is_below(fs::absolute(c.series).lexically_normal(), entry.path());
    });
    if (!used && texts.find(name) == std::string::npos) unused.push_back(entry.path());
  }
  std::sort(unused.begin(), unused.end());
  return unused;
}

}  // namespace trephine::library
