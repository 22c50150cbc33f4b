// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "config/yaml_edit.h"
#include "desk/desk_library.h"

namespace trephine::desk {

/// What a person did to a case: lines of its configuration, which the next build repeats, and beside it a journal of
/// who did it, when and why, which no case is made of.

/// One line of the journal, CASE.desk/journal.json.
struct HandEntry {
  int id = 0;
  std::string when;           ///< UTC: 2026-11-25T18:30:00Z
  std::string by, why;        ///< a token, and free words
  std::string kind;           ///< landmark, burr_holes, value, patch, snake, cut, smooth, switch, import, approval
  std::string what;           ///< in words: "nasion: [0, -93.2, 40.1]"
  std::string anatomy, file;  ///< of a patch: the file's name in the folder
  std::string edit;           ///< of an edit that is no patch, as JSON: {"snake": {...}} (segmentation/edit_list.h)
  bool on = true;             ///< of a patch or edit: whether it counts
  bool is_correction() const { return !file.empty() || !edit.empty(); }
};
std::vector<HandEntry> read_journal(const DeskCase& one);
void write_journal(const DeskCase& one, const std::vector<HandEntry>& entries);
/// Appends it, with the next number and the time of now.
HandEntry& add_entry(std::vector<HandEntry>& entries, HandEntry entry);

struct HandChange {
  std::vector<config::YamlChange> changes;
  std::string base_sha256;  ///< of the text that the person saw, as config_sha256 gave it
  std::string by, why, kind, what;
  /// Looks at the configuration as it would be; throws where the change would have no effect. May be empty.
  std::function<void(const config::CaseConfig& now)> check;
};

/// Who wants it, why, and what that person saw, as a page's request says; nothing is changed yet. Throws
/// nlohmann::json::exception where it says nothing of it.
HandChange change_of(const nlohmann::json& request);

/// SHA-256 of the text that says now what the case is made of.
std::string config_sha256(const DeskCase& one);

/// Holds the library's desk lock while it lives; it waits a few seconds for another desk. Throws Error 75.
class DeskLock {
 public:
  explicit DeskLock(const DeskLibrary& library);
  ~DeskLock();
  DeskLock(const DeskLock&) = delete;
  DeskLock& operator=(const DeskLock&) = delete;

 private:
  int fd_ = -1;
};

/// Writes the change into the case's own configuration, which is made first where the case shares one with others:
/// comments and order stay (config/yaml_edit.h), and what comes out is read as `run` reads it before anything is
/// written. Then the journal. The caller holds the lock. Throws Error 75 where the text is no longer the one that the
/// person saw, 64 where the case cannot be changed, what read_case_config throws, 73, 74.
void save_change(DeskLibrary& library, const DeskCase& one, const HandChange& change, std::vector<HandEntry>& journal);

/// JSON as YAML on one line: numbers, texts, lists and maps of them. Throws Error 64 for anything else.
std::string yaml_of_json(const nlohmann::json& json);

}  // namespace trephine::desk
