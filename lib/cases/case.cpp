// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "cases/case_names.h"

namespace trephine::cases {

namespace fs = std::filesystem;

namespace {

using detail::manifest_name;

constexpr std::size_t content_digits = 16;

bool is_one_of(char c, std::string_view others) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || others.find(c) != std::string_view::npos;
}

bool is_hex(std::string_view s) {
  return std::all_of(s.begin(), s.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string text_of(const std::vector<char>& bytes) { return std::string(bytes.begin(), bytes.end()); }

}  // namespace

namespace detail {

bool is_case_file_name(std::string_view name) {
  const auto slash = name.find('/');
  if (slash != std::string_view::npos)
    return slash > 0 && is_case_file_name(name.substr(0, slash)) &&
           name.find('/', slash + 1) == std::string_view::npos && is_case_file_name(name.substr(slash + 1));
  return !name.empty() && name.size() <= 200 && name[0] != '.' && name != manifest_name &&
         std::all_of(name.begin(), name.end(), [](char c) { return is_one_of(c, "-_.") || (c >= 'A' && c <= 'Z'); });
}

bool is_content_name(std::string_view name) {
  const auto dot = name.rfind('.');
  return is_case_file_name(name) && dot != std::string_view::npos && dot > content_digits + 1 &&
         name[dot - content_digits - 1] == '-' && is_hex(name.substr(dot - content_digits, content_digits));
}

bool is_token(const std::string& text) {
  return !text.empty() && text.size() <= 64 && is_one_of(text[0], "") &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_one_of(c, "-_"); });
}

}  // namespace detail

namespace case_form {

const TextForm token{"^[a-z0-9][a-z0-9_-]{0,63}$", "1 to 64 of a-z, 0-9, '-' and '_', the first a letter or digit",
                     detail::is_token};
const TextForm file_name{"^(?!case\\.json$)([A-Za-z0-9_-][A-Za-z0-9._-]*/)?[A-Za-z0-9_-][A-Za-z0-9._-]*$",
                         "a name of a file of a case",
                         [](const std::string& text) { return detail::is_case_file_name(text); }};
const TextForm sha256{"^[0-9a-f]{64}$", "64 digits from 0 to 9 and a to f",
                      [](const std::string& text) { return text.size() == 64 && is_hex(text); }};
const TextForm shape_name{"^[a-z0-9_]{1,64}$", "1 to 64 of a-z, 0-9 and '_'", [](const std::string& text) {
                            return !text.empty() && text.size() <= 64 &&
                                   std::all_of(text.begin(), text.end(), [](char c) { return is_one_of(c, "_"); });
                          }};

}  // namespace case_form

const CaseAnatomy* CaseManifest::find_anatomy(std::string_view name) const {
  for (const auto& a : anatomies)
    if (a.name == name) return &a;
  return nullptr;
}

const CaseFile* CaseManifest::find_file(std::string_view name) const {
  for (const auto& f : files)
    if (f.name == name) return &f;
  return nullptr;
}

std::vector<std::string> overlapping_holes(const std::vector<CaseBurrHole>& holes) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < holes.size(); ++i)
    for (std::size_t j = i + 1; j < holes.size(); ++j) {
      const double apart = norm(holes[i].position_mm - holes[j].position_mm);
      const double least = (holes[i].diameter_mm + holes[j].diameter_mm) / 2;
      if (apart < least)
        lines.push_back(
            fmt::format("{} and {} overlap: their entries lie {:.1f} mm apart, from {:.1f} mm on they are two "
                        "holes; move one of them, or take it away",
                        holes[i].name, holes[j].name, apart, least));
    }
  return lines;
}

void validate_case_token(const std::string& token, ExitCode code) {
  if (!detail::is_token(token))
    throw Error(code, "", "case", "'" + token.substr(0, 80) + "' is no case token: " + case_form::token.what);
}

CaseManifest read_case(const fs::path& case_folder) {
  const fs::path file = case_folder / manifest_name;
  CaseManifest m;
  try {
    m = parse_case_json(text_of(read_file(file, detail::max_manifest_bytes)));
  } catch (Error& e) {
    e.in_file(file.string());
    throw;
  }
  for (const auto& f : m.files) {
    const fs::path path = case_folder / f.name;
    std::error_code error;
    const auto size = fs::file_size(path, error);
    if (error) throw Error(ExitCode::no_input, path.string(), "", "missing or not readable: " + error.message());
    if (size != f.bytes)
      throw Error(ExitCode::bad_input, path.string(), "size",
                  std::to_string(size) + " bytes, case.json says " + std::to_string(f.bytes) + detail::damaged_remedy);
    if (sha256_of_file(path) != f.sha256)
      throw Error(ExitCode::bad_input, path.string(), "checksum",
                  std::string("is not that of case.json: the file is damaged") + detail::damaged_remedy);
  }
  return m;
}

std::string read_case_file(const fs::path& case_folder, const CaseFile& file) {
  const fs::path path = case_folder / file.name;
  std::string bytes = text_of(read_file(path, file.bytes));
  if (bytes.size() != file.bytes || sha256_of_bytes(bytes) != file.sha256)
    throw Error(ExitCode::bad_input, path.string(), "checksum",
                std::string("is not that of case.json: the file is damaged") + detail::damaged_remedy);
  return bytes;
}

CaseFile describe_case_file(const std::string& stem, const std::string& extension, std::string_view bytes) {
  CaseFile f;
  f.sha256 = sha256_of_bytes(bytes);
  f.name = stem + "-" + f.sha256.substr(0, content_digits) + extension;
  f.bytes = bytes.size();
  if (!detail::is_content_name(f.name)) throw Error(ExitCode::internal, f.name, "", "is no name for a file of a case");
  return f;
}

CaseFile write_case_file(const fs::path& case_folder, const std::string& stem, const std::string& extension,
                         std::string_view bytes) {
  const CaseFile f = describe_case_file(stem, extension, bytes);
  const fs::path path = case_folder / f.name;
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (!error && size == f.bytes && sha256_of_file(path) == f.sha256) return f;
  make_output_folder(path.parent_path());
  write_file(path, bytes);
  return f;
}

void publish_case(const fs::path& case_folder, const CaseManifest& manifest) {
  const std::string json = to_json(manifest);
  for (const auto& f : manifest.files) {
    std::error_code error;
    const auto size = fs::file_size(case_folder / f.name, error);
    if (error || size != f.bytes)
      throw Error(ExitCode::internal, (case_folder / f.name).string(), "", "is not there as case.json would name it");
  }
  make_output_folder(case_folder);
  write_file(case_folder / manifest_name, json);
}

int remove_unnamed_case_files(const fs::path& case_folder) {
  const CaseManifest m = read_case(case_folder);
  int removed = remove_stale_temporaries(case_folder);
  std::set<fs::path> folders{case_folder};
  for (const auto& entry : fs::directory_iterator(case_folder))
    if (entry.is_directory() && !entry.is_symlink() && entry.path().filename() == "meshes")
      folders.insert(entry.path());
  for (const auto& folder : folders) {
    if (folder != case_folder) removed += remove_stale_temporaries(folder);
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().lexically_relative(case_folder).generic_string();
      std::error_code error;
      if (entry.is_regular_file() && detail::is_content_name(name) && !m.find_file(name))
        removed += fs::remove(entry.path(), error) ? 1 : 0;
    }
  }
  return removed;
}

}  // namespace trephine::cases
