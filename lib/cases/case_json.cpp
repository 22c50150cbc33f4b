// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "cases/case.h"
#include "cases/case_check.h"
#include "cases/case_names.h"
#include "json/declared_json.h"

namespace trephine::cases {
namespace {

// The bytes at either end that a reader finds without parsing: the version first, the checksum last.
const std::string head = "{\n \"format\": \"trephine-case ";
const std::string tail_begin = ",\n \"checksum\": \"", tail_end = "\"\n}\n";
constexpr std::size_t hex_digits = 64;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

// Throws where the bytes do not begin as a case of a version that we read.
void read_version(std::string_view json, CaseManifest& m) {
  if (json.substr(0, head.size()) != head) refuse("format", "not a case.json of Trephine");
  const std::string_view rest = json.substr(head.size(), 32);
  const std::string_view version = rest.substr(0, rest.find('"'));
  const auto dot = version.find('.');
  const auto major = parse_integer(version.substr(0, dot));
  const auto minor = dot == std::string_view::npos ? std::nullopt : parse_integer(version.substr(dot + 1));
  if (!major || !minor || *major < 1 || *minor < 0 || *major > 9999 || *minor > 9999)
    refuse("format", "the version is damaged");
  if (*major != case_version_major)
    refuse("format", "version " + std::string(version) + ", this program reads versions " +
                         std::to_string(case_version_major) + ".*: " +
                         (*major < case_version_major ? "make the case again with `trephine run`"
                                                      : "take a newer Trephine, or make the case again with this one"));
  m.version_major = static_cast<int>(*major);
  m.version_minor = static_cast<int>(*minor);
}

}  // namespace

std::string case_version() { return std::to_string(case_version_major) + "." + std::to_string(case_version_minor); }

std::string to_json(const CaseManifest& manifest) {
  CaseManifest m = manifest;
  std::sort(m.files.begin(), m.files.end(), [](const CaseFile& a, const CaseFile& b) { return a.name < b.name; });
  detail::check_manifest(m);
  const std::string body = json::declared_json(parameters_of<CaseManifest>(), &m);
  // "{\n ...\n}": between the version before it and the checksum after it.
  std::string out = head + std::to_string(m.version_major) + "." + std::to_string(m.version_minor) + "\",";
  out += body.substr(1, body.size() - 3);
  return out + tail_begin + sha256_of_bytes(out) + tail_end;
}

CaseManifest parse_case_json(std::string_view json) {
  CaseManifest m;
  read_version(json, m);
  const std::size_t tail = tail_begin.size() + hex_digits + tail_end.size();
  if (json.size() < head.size() + tail)
    refuse("checksum", std::string("the file is cut short") + detail::damaged_remedy);
  const std::string_view covered = json.substr(0, json.size() - tail);
  if (std::string(json.substr(covered.size())) != tail_begin + sha256_of_bytes(covered) + tail_end)
    refuse("checksum", std::string("is not that of the file: it is damaged or was edited") + detail::damaged_remedy);
  json::JsonRules rules;
  rules.by_program = true;
  rules.max_bytes = detail::max_manifest_bytes;
  json::read_declared_json(json, parameters_of<CaseManifest>(), &m, rules);
  try {
    detail::check_manifest(m);
  } catch (const Error& e) {
    if (e.code() != ExitCode::internal) throw;
    refuse(e.field(), e.what());
  }
  return m;
}

}  // namespace trephine::cases
