// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "dicom/archive.h"
#include "dicom/elements.h"

namespace trephine::dicom {

/// Which file of a scan has which place and digest in messages, as text: a line for each file with its place from 1,
/// its digest and its path below `folder_or_file`, parted by tabulators. It holds names, which may be patients': it
/// belongs into a file that only its owner may read. Throws as import_series does where the folder or archive cannot be
/// read.
std::string scan_file_map(const std::filesystem::path& folder_or_file, const Progress& progress = {});

/// A file to look into. Its path, below the folder or archive that was named, may be a patient's name, so messages call
/// it by name_of_input.
struct InputFile {
  Origin origin;
  std::string path;
};

/// The files of a scan, ascending by path.
struct InputList {
  Archive archive;  ///< holds the bytes of an archive's members
  std::vector<InputFile> files;
  int hidden = 0, links = 0, unreadable_folders = 0;
};
/// Throws Error 66 where the folder cannot be read; what read_archive throws.
InputList list_inputs(const std::filesystem::path& folder_or_file, const Progress& progress);

/// "scan: file 5 of 12 (1f3a9c02)": the place in the list, and the first 8 digits of the SHA-256 of the file's first
/// 4,096 bytes.
std::string name_of_input(const std::vector<InputFile>& files, std::size_t at);
/// "scan" for a folder, "scan (1f3a9c02)" for a file.
std::string name_of_scan(const std::filesystem::path& folder_or_file);

/// The same error with the scan's name instead of a path.
Error without_names(const Error& e, const std::filesystem::path& folder_or_file);

/// Runs f(); an Error that passes through names neither the scan's folder nor its files by their names.
template <class F>
auto with_scan(const std::filesystem::path& folder_or_file, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (const Error& e) {
    throw without_names(e, folder_or_file);
  }
}

}  // namespace trephine::dicom
