// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/series_state.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "dicom/volume_source.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr int deepest_level = 5;  // as deep as the import searches
// A file that changed this shortly before it was examined may change again within the same tick of its clock.
constexpr double racy_s = 0.1;
constexpr const char* format_name = "trephine-library-series 2";

using Item = std::tuple<std::uint64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t>;

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

void add_item(const struct stat& s, std::vector<Item>& items, double& latest_s) {
  items.emplace_back(s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec, s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
  latest_s = std::max(latest_s, static_cast<double>(s.st_ctim.tv_sec) + 1e-9 * static_cast<double>(s.st_ctim.tv_nsec));
}

bool add_folder(int fd, int level, std::vector<Item>& items, double& latest_s) {
  DIR* folder = fdopendir(fd);
  if (!folder) {
    close(fd);
    return false;
  }
  bool good = true;
  while (const dirent* entry = readdir(folder)) {
    const std::string name = entry->d_name;
    if (name == "." || name == "..") continue;
    struct stat s {};
    if (fstatat(dirfd(folder), entry->d_name, &s, AT_SYMLINK_NOFOLLOW) != 0) {
      good = false;
    } else if (S_ISDIR(s.st_mode)) {
      if (level >= deepest_level) continue;
      const int below = openat(dirfd(folder), entry->d_name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
      good = below >= 0 && add_folder(below, level + 1, items, latest_s) && good;
    } else {
      add_item(s, items, latest_s);
    }
  }
  closedir(folder);
  return good;
}

// The size of the chosen series in voxels; 0 where it is unknown.
std::uint64_t voxels_of(const fs::path& series, const dicom::ImportParams& params, const Progress& progress) {
  std::uint64_t largest = 0;
  for (const dicom::SeriesSummary& s : dicom::list_series(series, params, progress).series) {
    const std::uint64_t voxels = std::uint64_t(s.size[0]) * std::uint64_t(s.size[1]) * std::uint64_t(s.size[2]);
    if (!params.series.empty() && s.token.rfind(params.series, 0) == 0) return voxels;
    if (s.usable) largest = std::max(largest, voxels);
  }
  return largest;
}

}  // namespace

FileSignature sign_files(const fs::path& folder_or_file) {
  std::vector<Item> items;
  FileSignature out;
  struct stat s {};
  if (stat(folder_or_file.c_str(), &s) != 0) return {};
  if (S_ISDIR(s.st_mode)) {
    const int fd = open(folder_or_file.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0 || !add_folder(fd, 1, items, out.latest_change_s)) return {};
  } else {
    add_item(s, items, out.latest_change_s);
  }
  std::sort(items.begin(), items.end());
  Sha256 sha;
  sha.text("trephine file signature 1").integer(static_cast<std::int64_t>(items.size()));
  if (!items.empty()) sha.bytes(items.data(), items.size() * sizeof(Item));
  out.sha256 = sha.hex();
  return out;
}

namespace {

// Of all files that are read with the series.
FileSignature sign_all(const fs::path& series) {
  FileSignature all = sign_files(series);
  Sha256 sha;
  sha.text(all.sha256);
  for (const fs::path& file : dicom::files_beside(series)) {
    const FileSignature one = sign_files(file);
    if (one.sha256.empty()) return {};
    sha.text(one.sha256);
    all.latest_change_s = std::max(all.latest_change_s, one.latest_change_s);
  }
  if (!all.sha256.empty()) all.sha256 = sha.hex();
  return all;
}

}  // namespace

SeriesMemory::SeriesMemory(fs::path file) : file_(std::move(file)) {
  std::error_code ignored;
  if (!fs::exists(file_, ignored)) return;
  try {
    const std::vector<char> bytes = read_file(file_, std::uint64_t{1} << 28);
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    if (json.at("format") != format_name) return;
    const std::string text = json.at("series").dump();
    if (json.at("checksum") != sha256_of_bytes(text)) return;
    for (const auto& [key, value] : json.at("series").items())
      entries_[key].content = {value.at(0).get<std::string>(), value.at(1).get<std::uint64_t>()};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    entries_.clear();  // the file is damaged: everything is read again
  }
}

SeriesContent SeriesMemory::content_of(const fs::path& series, const dicom::ImportParams& params, bool rehash,
                                       const Progress& progress) {
  const FileSignature files = sign_all(series);
  Sha256 sha;
  sha.text(files.sha256).text(params.series).integer(static_cast<int>(params.modality));
  const std::string key = sha.hex();
  const double looked_s = now_s();
  if (!files.sha256.empty() && !rehash) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = entries_.find(key);
    if (found != entries_.end()) {
      found->second.used = true;
      return found->second.content;
    }
  }
  SeriesContent content;
  content.sha256 = dicom::hash_of_series_input(series, params, progress);
  content.voxels = voxels_of(series, params, progress);
  const bool unchanged = sign_all(series).sha256 == files.sha256;
  if (files.sha256.empty() || !unchanged || looked_s - files.latest_change_s < racy_s) return content;
  const std::lock_guard<std::mutex> lock(mutex_);
  Entry& entry = entries_[key];
  changed_ = changed_ || entry.content.sha256 != content.sha256 || entry.content.voxels != content.voxels;
  entry = {content, true};
  return content;
}

void SeriesMemory::forget_others() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto it = entries_.begin(); it != entries_.end();) {
    changed_ = changed_ || !it->second.used;
    it = it->second.used ? std::next(it) : entries_.erase(it);
  }
}

void SeriesMemory::save(bool now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!changed_ || (!now && now_s() - saved_s_ < 1)) return;
  nlohmann::json json, series = nlohmann::json::object();
  for (const auto& [key, entry] : entries_) series[key] = {entry.content.sha256, entry.content.voxels};
  json["format"] = format_name;
  json["checksum"] = sha256_of_bytes(series.dump());
  json["series"] = std::move(series);
  write_file(file_, json.dump(1) + "\n");
  changed_ = false;
  saved_s_ = now_s();
}

}  // namespace trephine::library
