// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/input_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>

#include "base/error.h"
#include "base/hash.h"
#include "base/open_beneath.h"

namespace trephine::dicom {
namespace {

namespace fs = std::filesystem;

constexpr int max_depth = 5;
constexpr std::size_t max_files = 200000;
constexpr std::size_t digested_bytes = 4096;

bool is_hidden(const fs::path& p) {
  const std::string s = p.filename().string();
  return !s.empty() && s[0] == '.';
}

// A link to a file beneath the folder is a file; what it leads to elsewhere is no part of the series that was named.
bool leads_out(const fs::path& link, const fs::path& folder) {
  const int fd = open_beneath(folder, link.lexically_relative(folder));
  if (fd >= 0) ::close(fd);
  return fd < 0;
}

void list_files(const fs::path& top, const fs::path& folder, int depth, std::vector<fs::path>& files, InputList& c) {
  std::error_code ec;
  std::vector<fs::path> entries;
  for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) entries.push_back(it->path());
  if (ec) {
    if (depth == 0) throw Error(ExitCode::no_input, "", "", "the folder cannot be read: " + ec.message());
    ++c.unreadable_folders;
    return;
  }
  std::sort(entries.begin(), entries.end());
  for (const fs::path& p : entries) {
    if (is_hidden(p)) {
      ++c.hidden;
      continue;
    }
    const fs::file_status own = fs::symlink_status(p, ec);
    if (fs::is_directory(own)) {  // links to folders are not followed: they may lead round in circles
      if (depth < max_depth) list_files(top, p, depth + 1, files, c);
    } else if (fs::is_symlink(own)) {
      if (leads_out(p, top) || !fs::is_regular_file(fs::status(p, ec)))
        ++c.links;  // to a folder, out of the folder that was named, or nowhere
      else
        files.push_back(p);
    } else if (fs::is_regular_file(own)) {
      files.push_back(p);
      if (files.size() > max_files)
        throw Error(ExitCode::bad_input, "", "", fmt::format("more than {} files", max_files));
    }
  }
}

std::string digest_of_input(const Origin& origin) {
  try {
    ByteSource source(origin);
    const std::size_t size = std::min<std::uint64_t>(source.size(), digested_bytes);
    const std::uint8_t* p = source.get(0, size);
    return sha256_of_bytes({reinterpret_cast<const char*>(p), p ? size : 0}).substr(0, 8);
  } catch (const std::system_error&) {
    return "";
  }
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  if (what.size() < 2) return;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

}  // namespace

InputList list_inputs(const fs::path& folder_or_file, const Progress& progress) {
  InputList list;
  if (fs::is_directory(folder_or_file)) {
    std::vector<fs::path> paths;
    list_files(folder_or_file, folder_or_file, 0, paths, list);
    for (const fs::path& p : paths)
      list.files.push_back({Origin::beneath(folder_or_file, p), p.lexically_relative(folder_or_file).string()});
  } else if (is_zip(folder_or_file)) {
    list.archive = read_archive(folder_or_file, progress);
    list.hidden = list.archive.hidden;
    list.links = list.archive.links;
    for (const Archive::Member& m : list.archive.members) list.files.push_back({Origin::memory(m.bytes), m.name});
  } else {
    list.files.push_back({folder_or_file, folder_or_file.filename().string()});
  }
  return list;
}

std::string name_of_input(const std::vector<InputFile>& files, std::size_t at) {
  const std::string digest = digest_of_input(files[at].origin);
  const std::string name = files.size() == 1 ? "scan" : fmt::format("scan: file {} of {}", at + 1, files.size());
  return digest.empty() ? name : name + " (" + digest + ")";
}

std::string name_of_scan(const fs::path& folder_or_file) {
  std::error_code ec;
  if (!fs::is_regular_file(folder_or_file, ec)) return "scan";
  return name_of_input({{folder_or_file, ""}}, 0);
}

Error without_names(const Error& e, const fs::path& folder_or_file) {
  std::string form = e.message().form();
  const std::string name = name_of_scan(folder_or_file);
  replace_all(form, folder_or_file.string(), name);
  Error out = e;
  if (e.file().rfind("scan", 0) != 0) out.refiled(name);
  return out.reworded({form, e.message().settings()});
}

}  // namespace trephine::dicom

namespace trephine::dicom {

std::string scan_file_map(const std::filesystem::path& folder_or_file, const Progress& progress) {
  return with_scan(folder_or_file, [&] {
    const InputList list = list_inputs(folder_or_file, progress);
    std::string map = "place\tdigest\tpath\n";
    for (std::size_t i = 0; i < list.files.size(); ++i)
      map += fmt::format("{}\t{}\t{}\n", i + 1, digest_of_input(list.files[i].origin), list.files[i].path);
    return map;
  });
}

}  // namespace trephine::dicom
