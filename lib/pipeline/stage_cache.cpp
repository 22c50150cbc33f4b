// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_cache.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "stages/data_files.h"

namespace trephine {
namespace fs = std::filesystem;

StageCache::StageCache(fs::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) return;
  make_output_folder(folder_);
  std::error_code ignored;
  fs::permissions(folder_, fs::perms::owner_all, ignored);
  remove_stale_temporaries(folder_);
}

fs::path StageCache::file(const std::string& key, const char* extension) const { return folder_ / (key + extension); }

bool StageCache::has(const std::string& key) const {
  std::error_code ignored;
  return !folder_.empty() && fs::exists(file(key, ".json"), ignored);
}

std::optional<StageCache::Entry> StageCache::load(const std::string& key, DataKind kind) const {
  if (!has(key)) return {};
  const fs::path index = file(key, ".json"), data = file(key, file_extension(kind));
  try {
    const std::vector<char> bytes = read_file(index, 1 << 20);
    const auto json = nlohmann::ordered_json::parse(bytes.begin(), bytes.end());
    Entry entry;
    entry.report = parse_report_json(json.at("report").get<std::string>());
    if (kind != DataKind::nothing) {
      if (sha256_of_file(data) != json.at("sha256").get<std::string>())
        throw Error(ExitCode::bad_input, data.string(), "sha256", "differs");
      entry.data = load_data(data, kind);
    }
    std::error_code ignored;
    fs::last_write_time(index, fs::file_time_type::clock::now(), ignored);
    return entry;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    // Damaged, torn or of another version: as if it were not there.
    std::error_code ignored;
    fs::remove(index, ignored);
    if (kind != DataKind::nothing) fs::remove(data, ignored);
    return {};
  }
}

void StageCache::store(const std::string& key, DataKind kind, const StageData& data, const Report& report) const {
  if (folder_.empty()) return;
  nlohmann::ordered_json json;
  if (kind != DataKind::nothing) {
    save_data(file(key, file_extension(kind)), data);
    json["sha256"] = sha256_of_file(file(key, file_extension(kind)));
  }
  json["report"] = report_json(report);
  write_file(file(key, ".json"), json.dump());
}

void StageCache::shrink_to(std::uint64_t max_bytes) const {
  if (folder_.empty()) return;
  struct Item {
    fs::file_time_type used{};
    std::uint64_t bytes = 0;
    std::vector<fs::path> files;
  };
  std::map<std::string, Item> items;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string stem = entry.path().stem().string();
    if (stem.size() != 64 || !entry.is_regular_file(ignored)) continue;
    Item& item = items[stem];
    item.bytes += entry.file_size(ignored);
    item.used = std::max(item.used, entry.last_write_time(ignored));
    item.files.push_back(entry.path());
  }
  std::vector<const Item*> by_age;
  std::uint64_t total = 0;
  for (const auto& [stem, item] : items) {
    by_age.push_back(&item);
    total += item.bytes;
  }
  std::stable_sort(by_age.begin(), by_age.end(), [](const Item* a, const Item* b) { return a->used < b->used; });
  for (const Item* item : by_age) {
    if (total <= max_bytes) break;
    // The index goes first: data without an index is no entry.
    for (const fs::path& f : item->files)
      if (f.extension() == ".json") fs::remove(f, ignored);
    for (const fs::path& f : item->files) fs::remove(f, ignored);
    total -= item->bytes;
  }
}

}  // namespace trephine
