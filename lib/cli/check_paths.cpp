// SPDX-License-Identifier: GPL-3.0-or-later
// Paths are checked before any work starts, so that an hour's result does not meet a folder that is not there.
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "cli/declarations.h"

namespace trephine::cli {
namespace fs = std::filesystem;
namespace {

std::string reason() { return std::strerror(errno); }

// Of a scan's path, which may name a patient, no part is shown: how many of them are there says where it ends.
std::string scan_not_found(const fs::path& path) {
  int parts = 0, there = 0;
  fs::path upto;
  std::error_code ignored;
  for (const fs::path& part : path) {
    upto /= part;
    if (part.empty() || part == "/" || part == ".") continue;
    ++parts;
    there += fs::exists(upto, ignored);
  }
  return "not found: of the " + std::to_string(parts) + (parts == 1 ? " part" : " parts") +
         " of the path that is given " +
         (there == 0 ? "none exists" : "the first " + std::to_string(there) + " exist") +
         "; check how the next one is written, and put a path with blanks in quotes";
}

// The fault, or "" where the path exists, can be read and is of the right kind.
std::string input_fault(const fs::path& path, bool file_allowed, bool folder_allowed) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return "not found";
  if (error) return "cannot be read: " + error.message();
  if (fs::is_directory(status) && !folder_allowed) return "is a folder, a file is needed";
  if (!fs::is_directory(status) && !file_allowed) return "is not a folder";
  if (::access(path.c_str(), R_OK | (fs::is_directory(status) ? X_OK : 0)) != 0) return "cannot be read: " + reason();
  return "";
}

std::string folder_fault(const fs::path& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::not_found) return "there is no such folder";
  if (error) return error.message();
  if (!fs::is_directory(status)) return "is not a folder";
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return "the folder is not writable: " + reason();
  return "";
}

std::string output_file_fault(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_directory(status)) return "cannot be created: it is a folder";
  if (!file.has_filename()) return "cannot be created: it names no file";
  if (fs::exists(status) && !fs::is_regular_file(status)) return "";  // a device or pipe
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::string fault = folder_fault(folder);
  return fault.empty() ? "" : "cannot be created: its folder: " + fault;
}

std::string output_folder_fault(const fs::path& folder) {
  std::error_code error;
  fs::path existing = fs::absolute(folder, error).lexically_normal();
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  const std::string fault = folder_fault(existing);
  return fault.empty() ? "" : "cannot be created: " + existing.string() + ": " + fault;
}

}  // namespace

void check_paths(const ParsedCommand& parsed) {
  std::vector<Error> faults;
  for (const Argument& a : parsed.command->arguments)
    for (const std::string& value : parsed.all(a.name)) {
      std::string fault;
      ExitCode code = ExitCode::no_input;
      std::error_code ignored;
      switch (a.kind) {
        case Argument::Kind::in_file:
          fault = input_fault(value, true, false);
          break;
        case Argument::Kind::in_folder:
          fault = input_fault(value, false, true);
          break;
        case Argument::Kind::in_path:
          fault = input_fault(value, true, true);
          break;
        case Argument::Kind::in_scan:
          fault = fs::status(value, ignored).type() == fs::file_type::not_found ? scan_not_found(value)
                                                                                : input_fault(value, true, true);
          break;
        case Argument::Kind::out_file:
          fault = output_file_fault(value);
          code = ExitCode::cannot_create;
          break;
        case Argument::Kind::out_folder:
          if (!parsed.command->only_looks || !parsed.command->only_looks(parsed)) fault = output_folder_fault(value);
          code = ExitCode::cannot_create;
          break;
        case Argument::Kind::text:
        case Argument::Kind::choice:
          break;
      }
      const bool is_scan = a.kind == Argument::Kind::in_scan;
      if (!fault.empty()) faults.emplace_back(code, is_scan ? "scan" : value, name_of(a), fault);
    }
  if (!faults.empty()) throw ErrorList(faults);
}

}  // namespace trephine::cli
