// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_cache.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "stages/data_files.h"

namespace trephine::pipeline {
namespace fs = std::filesystem;

// No data file has this extension: cutters are .json.
constexpr const char* index_extension = ".index";
constexpr const char* seconds_file = "seconds.json";

namespace {

// What others may write, or wrote, can hold anything under any name.
void check_owned(const fs::path& folder) {
  struct stat s {};
  if (::stat(folder.c_str(), &s) != 0) return;
  if (s.st_uid != ::geteuid())
    throw Error(ExitCode::cannot_create, folder.string(), "cache",
                "belongs to another user, who could put results of his own into cases: sudo chown -R \"$USER\" '" +
                    folder.string() + "', after emptying it, or choose another folder");
  if ((s.st_mode & (S_IWGRP | S_IWOTH)) != 0)
    throw Error(
        ExitCode::cannot_create, folder.string(), "cache",
        "may be written by others, who could put results of their own into cases: chmod 700 '" + folder.string() + "'");
}

// An entry that somebody else wrote while he could is none.
bool is_our_file(const fs::path& file) {
  struct stat s {};
  return ::lstat(file.c_str(), &s) == 0 && S_ISREG(s.st_mode) && s.st_uid == ::geteuid() && (s.st_mode & S_IWOTH) == 0;
}

// The checksum of an entry's data is of the key, the kind and the bytes, so that data of another entry has another one.
std::string data_sha256(const std::string& key, const fs::path& data) {
  return Sha256().text("data of").text(key).text(data.extension().string()).text(sha256_of_file(data)).hex();
}

nlohmann::ordered_json json_of(const Error& refusal) {
  nlohmann::ordered_json settings = nlohmann::ordered_json::array();
  for (const Setting& s : refusal.message().settings()) settings.push_back({s.parameter, s.value, s.stage});
  return {{"field", refusal.field()},
          {"what", refusal.message().form()},
          {"settings", settings},
          {"cause", static_cast<int>(refusal.cause())},
          {"about", refusal.about()}};
}

Error refusal_of(const nlohmann::ordered_json& json) {
  std::vector<Setting> settings;
  for (const auto& s : json.at("settings"))
    settings.push_back({s.at(0).get<std::string>(), s.at(1).get<std::string>(), s.at(2).get<std::string>()});
  Error e(ExitCode::quality, "", json.at("field").get<std::string>(),
          Message(json.at("what").get<std::string>(), std::move(settings)));
  e.because(static_cast<Cause>(json.at("cause").get<int>()));
  return e.finds_fault_with(json.at("about").get<std::vector<std::string>>());
}

// The index as it is stored: its text and the checksum of that. Throws where it is damaged or is that of another key.
nlohmann::ordered_json parse_index(const std::vector<char>& bytes, const std::string& key) {
  const auto outer = nlohmann::ordered_json::parse(bytes.begin(), bytes.end());
  const std::string text = outer.at("entry").get<std::string>();
  if (outer.at("sha256").get<std::string>() != sha256_of_bytes(text))
    throw Error(ExitCode::bad_input, "", "entry", "differs from its checksum");
  auto entry = nlohmann::ordered_json::parse(text);
  if (entry.at("key").get<std::string>() != key) throw Error(ExitCode::bad_input, "", "key", "is another one");
  return entry;
}

}  // namespace

StageCache::StageCache(fs::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) return;
  std::error_code ignored;
  // Only a folder that we make is closed to others: a folder that the user names may be shared, even /tmp.
  const bool is_new = !fs::exists(folder_, ignored);
  make_output_folder(folder_);
  if (is_new) fs::permissions(folder_, fs::perms::owner_all, ignored);
  check_owned(folder_);
  remove_stale_temporaries(folder_);
}

fs::path StageCache::file(const std::string& key, const char* extension) const { return folder_ / (key + extension); }

std::optional<StageCache::Index> StageCache::load_index(const std::string& key) const {
  std::error_code ignored;
  const fs::path index = folder_.empty() ? fs::path() : file(key, index_extension);
  if (index.empty() || !fs::exists(index, ignored)) return {};
  try {
    if (!is_our_file(index)) throw Error(ExitCode::bad_input, index.string(), "", "is not ours");
    const auto json = parse_index(read_file(index, 1 << 20), key);
    Index out;
    if (const auto refused = json.find("refusal"); refused != json.end())
      out.refusal = refusal_of(*refused);
    else
      out.outcome = json.at("outcome").get<std::string>();
    out.sha256 = json.value("sha256", std::string());
    fs::last_write_time(index, fs::file_time_type::clock::now(), ignored);
    return out;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    fs::remove(index, ignored);  // a damaged, torn or outdated entry counts as missing
    return {};
  }
}

StageCache::Outcome StageCache::load_outcome(const std::string& key, const stages::StageType& type) const {
  auto index = load_index(key);
  if (!index) return {};
  if (index->refusal) return {{}, std::move(index->refusal)};
  try {
    return {stages::parse_outcome_json(index->outcome, type), {}};
  } catch (const Error&) {  // of another program
    std::error_code ignored;
    fs::remove(file(key, index_extension), ignored);
    return {};
  }
}

std::optional<stages::StageData> StageCache::load_data(const std::string& key, stages::DataKind kind) const {
  const auto index = load_index(key);
  if (!index || index->refusal) return {};
  if (kind == stages::DataKind::nothing) return stages::StageData{};
  if (index->sha256.empty()) return {};
  const fs::path data = file(key, stages::file_extension(kind));
  try {
    if (!is_our_file(data) || data_sha256(key, data) != index->sha256)
      throw Error(ExitCode::bad_input, data.string(), "sha256", "differs");
    return trephine::stages::load_data(data, kind, stages::DataOf::cache);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    std::error_code ignored;
    fs::remove(file(key, index_extension), ignored);
    fs::remove(data, ignored);
    return {};
  }
}

void StageCache::store(const std::string& key, stages::DataKind kind, const stages::StageOutcome& made,
                       double seconds) const {
  if (folder_.empty()) return;
  nlohmann::ordered_json json;
  json["key"] = key;
  if (!std::holds_alternative<std::monostate>(made.data)) {
    stages::save_data(file(key, stages::file_extension(kind)), made.data);
    json["sha256"] = data_sha256(key, file(key, stages::file_extension(kind)));
  }
  json["outcome"] = stages::outcome_json(made);
  json["seconds"] = seconds;
  write_index(key, json.dump());
}

void StageCache::store_refusal(const std::string& key, const Error& refusal) const {
  if (folder_.empty()) return;
  nlohmann::ordered_json json;
  json["key"] = key;
  json["refusal"] = json_of(refusal);
  write_index(key, json.dump());
}

void StageCache::write_index(const std::string& key, const std::string& entry) const {
  write_file(file(key, index_extension),
             nlohmann::ordered_json{{"entry", entry}, {"sha256", sha256_of_bytes(entry)}}.dump());
}

std::map<std::string, double> StageCache::seconds_before() const {
  std::error_code ignored;
  const fs::path file = folder_.empty() ? fs::path() : folder_ / seconds_file;
  if (file.empty() || !fs::exists(file, ignored)) return {};
  try {
    if (!is_our_file(file)) return {};
    const auto bytes = read_file(file, 1 << 20);
    auto seconds = nlohmann::json::parse(bytes.begin(), bytes.end()).get<std::map<std::string, double>>();
    for (auto it = seconds.begin(); it != seconds.end();)
      it = it->second > 0 && it->second < 1e6 ? std::next(it) : seconds.erase(it);
    return seconds;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return {};
  }
}

void StageCache::remember_seconds(const std::map<std::string, double>& newer) const {
  if (folder_.empty() || newer.empty()) return;
  std::map<std::string, double> seconds = seconds_before();
  for (const auto& [name, s] : newer) seconds[name] = std::max(s, 1e-3);
  try {
    write_file(folder_ / seconds_file, nlohmann::json(seconds).dump());
  } catch (const Error&) {  // an estimate is worth no failure
  }
}

StageCache::Entry StageCache::look_up(const std::string& key) const {
  std::error_code ignored;
  const fs::path index = folder_.empty() ? fs::path() : file(key, index_extension);
  if (index.empty() || !fs::exists(index, ignored)) return {};
  try {
    const auto json = parse_index(read_file(index, 1 << 20), key);
    Entry entry;
    entry.has_result = json.contains("outcome");
    entry.has_data = json.contains("sha256");
    if (const auto s = json.find("seconds"); s != json.end() && s->is_number()) entry.seconds = s->get<double>();
    return entry;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return {};
  }
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
    // The index is removed first: data without an index is no entry.
    for (const fs::path& f : item->files)
      if (f.extension() == index_extension) fs::remove(f, ignored);
    for (const fs::path& f : item->files) fs::remove(f, ignored);
    total -= item->bytes;
  }
}

bool worth_storing(const stages::StageData& data, double seconds) {
  constexpr double disk_bytes_per_s = 100e6, gain = 4, small_bytes = 1e6;
  // The file of a haptic volume does not hold its hardness.
  if (const auto* h = std::get_if<std::shared_ptr<const voxel::HapticVolume>>(&data))
    if (!(*h)->hardness.voxels.empty()) return false;
  const double bytes = stages::bytes_in_memory(data);
  return bytes <= small_bytes || seconds > gain * bytes / disk_bytes_per_s;
}

}  // namespace trephine::pipeline
