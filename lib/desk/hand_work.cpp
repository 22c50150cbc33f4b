// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/hand_work.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/text.h"
#include "base/write_file.h"
#include "desk/draft.h"
#include "lesson/approval.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t max_journal_bytes = 16 << 20, max_config_bytes = 1 << 20;
constexpr std::size_t max_why = 500;

std::string read_text(const fs::path& file) {
  const std::vector<char> bytes = read_file(file, max_config_bytes);
  return {bytes.begin(), bytes.end()};
}

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

/// The own configuration's place in LIBRARY.yaml, as a path relative to that file.
std::string edited_library(const DeskLibrary& library, const DeskCase& one) {
  const fs::path& file = library.options().config;
  std::vector<std::string> at = one.at;
  at.emplace_back("config");
  const fs::path relative = one.config.lexically_relative(fs::absolute(file).lexically_normal().parent_path());
  return config::edited_yaml(read_text(file), {{at, config::yaml_scalar(relative.string())}}, file);
}

}  // namespace

std::vector<HandEntry> read_journal(const DeskCase& one) {
  std::vector<HandEntry> out;
  std::error_code ignored;
  const fs::path file = one.hand_folder() / "journal.json";
  if (!fs::exists(file, ignored)) return out;
  const std::vector<char> bytes = read_file(file, max_journal_bytes);
  try {
    const Json json = Json::parse(bytes.begin(), bytes.end());
    for (const Json& e : json.at("entries")) {
      HandEntry entry;
      entry.id = e.at("id").get<int>();
      for (const auto& [key, to] : {std::pair<const char*, std::string*>{"when", &entry.when},
                                    {"by", &entry.by},
                                    {"why", &entry.why},
                                    {"kind", &entry.kind},
                                    {"what", &entry.what},
                                    {"anatomy", &entry.anatomy},
                                    {"file", &entry.file}})
        *to = e.value(key, "");
      if (e.contains("edit")) entry.edit = e.at("edit").dump();
      entry.on = e.value("on", true);
      if (entry.file.find('/') != std::string::npos || (!entry.file.empty() && entry.file.front() == '.'))
        throw Error(ExitCode::bad_input, "", "file", "leads out of the folder");
      out.push_back(std::move(entry));
    }
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, file.string(), "", "is damaged: not a journal of the desk");
  }
  return out;
}

void write_journal(const DeskCase& one, const std::vector<HandEntry>& entries) {
  Json json = {{"trephine_desk", 1}, {"entries", Json::array()}};
  for (const HandEntry& e : entries) {
    Json out = {{"id", e.id}, {"when", e.when}, {"by", e.by}, {"why", e.why}, {"kind", e.kind}, {"what", e.what}};
    if (!e.anatomy.empty()) out["anatomy"] = e.anatomy;
    if (!e.file.empty()) out["file"] = e.file;
    if (!e.edit.empty()) out["edit"] = Json::parse(e.edit);
    if (e.is_correction()) out["on"] = e.on;
    json["entries"].push_back(std::move(out));
  }
  make_output_folder(one.hand_folder());
  write_file(one.hand_folder() / "journal.json", json.dump(1, ' ', true, Json::error_handler_t::replace) + "\n");
}

HandEntry& add_entry(std::vector<HandEntry>& entries, HandEntry entry) {
  entry.id = entries.empty() ? 1 : entries.back().id + 1;
  entry.when = now_utc();
  entry.why = printable(entry.why.substr(0, max_why));
  entries.push_back(std::move(entry));
  return entries.back();
}

HandChange change_of(const nlohmann::json& request) {
  HandChange change;
  change.base_sha256 = request.at("base").get<std::string>();
  change.by = request.at("by").get<std::string>();
  change.why = request.value("why", "");
  return change;
}

std::string config_sha256(const DeskCase& one) { return sha256_of_bytes(read_text(one.text_file())); }

DeskLock::DeskLock(const DeskLibrary& library) {
  const fs::path folder = library.options().library / ".library";
  make_private_folder(folder);
  fd_ = ::open((folder / "desk.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd_ < 0) throw Error(ExitCode::cannot_create, (folder / "desk.lock").string(), "", "cannot be made");
  for (int i = 0; i < 100; ++i) {
    if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  ::close(fd_);
  throw Error(ExitCode::busy, "", "", "another desk is writing to this library, try again");
}

DeskLock::~DeskLock() { ::close(fd_); }

void save_change(DeskLibrary& library, const DeskCase& one, const HandChange& change, std::vector<HandEntry>& journal) {
  lesson::validate_token(change.by, "by");
  if (!one.fixed.empty()) throw Error(ExitCode::usage, "", one.token, one.fixed);
  const std::string text = read_text(one.text_file());
  if (sha256_of_bytes(text) != change.base_sha256)
    throw Error(ExitCode::busy, one.text_file().filename().string(), "",
                "was changed meanwhile, by another desk or an editor: open the case again");
  const std::string edited = config::edited_yaml(text, change.changes, one.config.filename());
  {
    const Draft draft(one.config, edited);
    const config::CaseConfig now =
        draft.judged([&](const fs::path& file) { return config::read_case_config(file, library.overrides_of(one)); });
    if (change.check) change.check(now);
  }
  if (!one.copied_from.empty()) {
    const std::string list = edited_library(library, one);
    const fs::path file = fs::absolute(library.options().config).lexically_normal();
    const Draft draft(file, list);
    write_file(one.config, edited);  // first, since LIBRARY.yaml is to name it
    draft.judged([&](const fs::path& f) { return library::read_library_config(f, {{}, {}, library.options().roots}); });
    write_file(file, list);
  } else {
    write_file(one.config, edited);
  }
  HandEntry entry;
  entry.by = change.by;
  entry.why = change.why;
  entry.kind = change.kind;
  entry.what = change.what;
  if (!entry.kind.empty()) add_entry(journal, std::move(entry));
  write_journal(one, journal);
  library.plan();
}

std::string yaml_of_json(const nlohmann::json& json) {
  std::string out;
  if (json.is_number()) {
    const double number = json.get<double>();
    return to_text(number);
  }
  if (json.is_boolean()) return json.get<bool>() ? "true" : "false";
  if (json.is_string()) return config::yaml_scalar(json.get<std::string>());
  if (json.is_array()) return "[" + joined(json, ", ", yaml_of_json) + "]";
  if (json.is_object()) {
    for (const auto& [key, value] : json.items())
      out += (out.empty() ? "" : ", ") + config::yaml_scalar(key) + ": " + yaml_of_json(value);
    return "{" + out + "}";
  }
  throw Error(ExitCode::usage, "", "value", "must be a number, a text, or a list or map of them");
}

}  // namespace trephine::desk
