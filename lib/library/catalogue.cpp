// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/joined.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/text_table.h"
#include "base/write_file.h"
#include "pipeline/executor.h"
#include "stages/warning_kind.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t max_bytes = std::uint64_t{16} << 20;
constexpr std::size_t rows_at_once = 64;

bool is_token(const std::string& name) {
  try {
    cases::validate_case_token(name, ExitCode::usage);
    return true;
  } catch (const Error&) {
    return false;
  }
}

void read_manifest_of(const fs::path& folder, CaseRow& row) {
  try {
    const std::vector<char> bytes = read_file(folder / "case.json", max_bytes);
    row.manifest = cases::parse_case_json({bytes.data(), bytes.size()});
    row.bytes = bytes.size();
    if (row.manifest.case_token != row.token) row.fault = "case.json is of case " + printable(row.manifest.case_token);
  } catch (const Error& e) {
    row.fault = printable((e.field().empty() ? "case.json: " : "case.json: " + e.field() + ": ") + e.what());
    return;
  }
  for (const cases::CaseAnatomy& a : row.manifest.anatomies) {
    row.triangles += a.triangles;
    row.deviation_max_mm = std::max(row.deviation_max_mm, a.deviation.max_mm);
  }
  for (const cases::CaseFile& f : row.manifest.files) row.bytes += f.bytes;
  if (const ParameterValue* v = row.figure("class"))
    if (const auto* text = std::get_if<std::string>(v)) row.patient_class = *text;
  std::error_code error;
  const auto written = fs::last_write_time(folder / "case.json", error);
  if (!error) row.age_s = std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
}

// run.json is only for people and may be missing.
void read_run(const fs::path& file, CaseRow& row) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return;
  try {
    const std::vector<char> bytes = read_file(file, max_bytes);
    const Json json = Json::parse(bytes.begin(), bytes.end());
    for (const auto& w : json.at("warnings")) row.warnings.push_back(printable(w.get<std::string>()));
    row.severities = json.value("severities", std::vector<std::string>());
    row.wrong_count =
        std::size_t(std::count(row.severities.begin(), row.severities.end(), stages::to_text(stages::Severity::wrong)));
    row.seconds = json.at("wall_s").get<double>();
    row.peak_memory_mb = json.value("peak_memory_mb", 0.0);
    const Json stages = json.value("stages", Json::object());
    for (const auto& [name, stage] : stages.items())
      if (stage.at("state") == pipeline::name_of(pipeline::NodeResult::State::computed))
        row.stage_seconds.emplace_back(name, stage.at("seconds").get<double>());
  } catch (const nlohmann::json::exception&) {
    row.warnings.clear();
  } catch (const Error&) {
    row.warnings.clear();
  }
}

bool fits(const CaseRow& row, const LibraryFilter& filter) {
  if (filter.failed && row.fault.empty() && row.last.code == 0) return false;
  if (filter.patient_class != CaseClass::any) {
    static const char* names[] = {"any", "normal", "hydrocephalic", "shifted", "small", "uncertain", ""};
    const std::string is = row.patient_class == "unknown" ? "" : row.patient_class;
    if (is != names[static_cast<int>(filter.patient_class)] || !row.fault.empty()) return false;
  }
  if (filter.max_deviation_mm > 0 && (!row.fault.empty() || row.deviation_max_mm > filter.max_deviation_mm))
    return false;
  return filter.max_warnings_count < 0 ||
         (row.fault.empty() && static_cast<std::int64_t>(row.warnings.size()) <= filter.max_warnings_count);
}

Json value_json(const ParameterValue& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

std::string state_of(const CaseRow& row) {
  if (!row.fault.empty()) return printable(row.fault);
  return row.last.code == 0 ? "" : fmt::format("last build failed: {}", row.last.code);
}

}  // namespace

const ParameterValue* CaseRow::figure(const std::string& name) const {
  for (const auto& [key, value] : manifest.figures)
    if (key == name) return &value;
  return nullptr;
}

std::vector<std::string> library_tokens(const fs::path& library) {
  std::error_code error;
  if (!fs::is_directory(library, error))
    throw Error(ExitCode::no_input, library.string(), "", "is no library's folder");
  std::set<std::string> tokens;
  for (fs::directory_iterator it(library, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (is_token(it->path().filename().string()) && fs::exists(it->path() / "case.json", ignored))
      tokens.insert(it->path().filename().string());
  }
  if (error) throw Error(ExitCode::no_input, library.string(), "", error.message());
  std::error_code no_state;
  const std::string ending = ".result.json";
  for (fs::directory_iterator it(LibraryState(library).folder() / "cases", no_state), end; !no_state && it != end;
       it.increment(no_state)) {
    const std::string name = it->path().filename().string();
    if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0 &&
        is_token(name.substr(0, name.size() - ending.size())))
      tokens.insert(name.substr(0, name.size() - ending.size()));
  }
  return {tokens.begin(), tokens.end()};
}

CaseRow read_row(const fs::path& library, const std::string& token) {
  CaseRow row;
  row.token = token;
  std::error_code ignored;
  if (fs::exists(library / token / "case.json", ignored)) {
    read_manifest_of(library / token, row);
    read_run(library / token / "run.json", row);
  } else {
    row.fault = "was never built";
  }
  if (const auto last = read_result(LibraryState(library), token)) row.last = *last;
  return row;
}

void each_case(const fs::path& library, const LibraryFilter& filter, const std::function<void(const CaseRow&)>& visit) {
  const std::vector<std::string> tokens = library_tokens(library);
  for (std::size_t from = 0; from < tokens.size(); from += rows_at_once) {
    std::vector<CaseRow> rows(std::min(rows_at_once, tokens.size() - from));
    parallel_for(0, static_cast<std::int64_t>(rows.size()), 4, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        rows[i] = read_row(library, tokens[from + i]);
    });
    for (const CaseRow& row : rows)
      if (fits(row, filter)) visit(row);
  }
}

std::string concessions_text(const CaseRow& row) {
  std::string text = joined(row.manifest.stand_ins, ", ",
                            [](const cases::CaseStandIn& s) { return s.by + " stands for " + s.anatomy; });
  for (const cases::CaseMissing& m : row.manifest.missing)
    text += (text.empty() ? "" : ", ") + m.anatomy + " is left out";
  return text;
}

CaseRow read_library_case(const fs::path& library, const std::string& token) {
  cases::validate_case_token(token, ExitCode::usage);
  const std::vector<std::string> known = library_tokens(library);
  if (std::binary_search(known.begin(), known.end(), token)) return read_row(library, token);
  const std::string near = nearest_name(token, known);
  throw Error(ExitCode::no_input, library.string(), token,
              "the library has no such case" + (near.empty() ? "" : ", did you mean " + near + "?"));
}

std::string fixed_text(double v, int decimals) {
  const std::string text = fmt::format("{:.{}f}", v, decimals);
  return text.find_first_not_of("-0.") == std::string::npos && text[0] == '-' ? text.substr(1) : text;
}

std::string age_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", std::max(seconds, 0.0));
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 36 * 3600) return fmt::format("{:.0f} h", seconds / 3600);
  return fmt::format("{:.0f} d", seconds / 86400);
}

std::string CaseRow::classed_by() const {
  const ParameterValue* v = figure("class_of");
  const auto* name = v ? std::get_if<std::string>(v) : nullptr;
  return name ? *name : "";
}

std::string figure_text(const CaseRow& row, const std::string& name, int decimals, double factor) {
  const ParameterValue* v = row.figure(name);
  if (!v) return "";
  if (const auto* d = std::get_if<double>(v)) return fixed_text(factor * *d, decimals);
  return to_text(*v);
}

std::string warnings_text(const CaseRow& row) {
  const std::string all = std::to_string(row.warnings.size());
  return row.wrong_count == 0 ? all : all + " (" + std::to_string(row.wrong_count) + " wrong)";
}

void LibraryTable::add(const CaseRow& row) {
  const bool good = row.fault.empty();
  if (classed_by_.empty()) classed_by_ = row.classed_by();
  cells_.push_back(
      {row.token, printable(row.patient_class), printable(figure_text(row, row.classed_by() + "_ml", 1)),
       printable(figure_text(row, "evans_index_ratio", 2)), printable(figure_text(row, "midline_shift_mm", 1)),
       good ? grouped_text(static_cast<long long>(row.triangles)) : "", good ? fixed_text(row.deviation_max_mm, 2) : "",
       good ? fixed_text(static_cast<double>(row.bytes) / 1e6, 1) : "",
       good && row.seconds > 0 ? fixed_text(row.seconds, 0) : "", good ? warnings_text(row) : "",
       good ? age_text(row.age_s) : "",
       printable(row.manifest.program_version.substr(row.manifest.program_version.find(' ') + 1)), state_of(row)});
}

std::string LibraryTable::text() const {
  std::vector<std::vector<std::string>> cells = {
      {"case", "class", classed_by_.empty() ? "ml" : printable(classed_by_) + " ml", "Evans", "shift mm", "triangles",
       "max mm", "MB", "s", "warnings", "age", "version", ""}};
  cells.insert(cells.end(), cells_.begin(), cells_.end());
  return text_table(cells, "llrrrrrrrrrrl") + std::to_string(cells_.size()) +
         (cells_.size() == 1 ? " case\n" : " cases\n");
}

void LibraryJson::add(const CaseRow& row) {
  Json json = {{"case", row.token}};
  if (!row.fault.empty()) json["fault"] = row.fault;
  if (row.last.code != 0) json["last_build"] = {{"code", row.last.code}, {"reason", row.last.reason}};
  if (row.fault.empty()) {
    json["class"] = row.patient_class;
    json["figures"] = Json::object();
    for (const auto& [name, value] : row.manifest.figures) json["figures"][name] = value_json(value);
    for (const cases::CaseAnatomy& a : row.manifest.anatomies)
      json["anatomies"][a.name] = {{"triangles", a.triangles},
                                   {"volume_ml", a.volume_ml},
                                   {"area_cm2", a.area_cm2},
                                   {"deviation_max_mm", a.deviation.max_mm},
                                   {"deviation_p99_mm", a.deviation.p99_mm}};
    for (const cases::CaseMissing& a : row.manifest.missing) json["missing"][a.anatomy] = a.why;
    for (const cases::CaseStandIn& a : row.manifest.stand_ins)
      json["stand_ins"][a.anatomy] = {{"by", a.by}, {"why", a.why}};
    for (const cases::CaseShape& s : row.manifest.haptic.shapes)
      json["haptic"][s.name] = {{"volume_ml", s.volume_ml}, {"mismatch_p99_mm", s.mismatch.p99_mm}};
    json["burr_holes_count"] = row.manifest.burr_holes.size();
    json["triangles"] = row.triangles;
    json["deviation_max_mm"] = row.deviation_max_mm;
    json["bytes"] = row.bytes;
    json["seconds"] = row.seconds;
    if (row.last.cpu_s > 0) json["cpu_s"] = row.last.cpu_s;
    json["warnings"] = row.warnings;
    json["severities"] = row.severities;
    json["age_s"] = std::max(0.0, row.age_s);
    json["version"] = row.manifest.program_version;
    json["input_sha256"] = row.manifest.input_sha256;
  }
  text_ += text_.empty() ? "[\n  " : ",\n  ";
  for (const char c : json.dump(2, ' ', true, Json::error_handler_t::replace))  // it may be printed
    text_ += c == '\n' ? std::string("\n  ") : std::string(1, c);
}

std::string LibraryJson::text() const { return (text_.empty() ? "[]" : text_ + "\n]") + "\n"; }

std::string case_text(const CaseRow& row) {
  std::string out = row.token + "\n";
  if (!row.fault.empty()) out += "  " + printable(row.fault) + "\n";
  if (row.last.code != 0)
    out += fmt::format("  its last build failed with {}: {}\n", row.last.code, printable(row.last.reason));
  if (!row.fault.empty()) return out;
  const cases::CaseManifest& m = row.manifest;
  out += fmt::format("  {}, {} old, {:.1f} MB, face: {}\n", printable(m.program_version), age_text(row.age_s),
                     static_cast<double>(row.bytes) / 1e6, m.face_policy);
  for (const cases::CaseAnatomy& a : m.anatomies)
    out += fmt::format("  {:<14} {:>9} triangles  {:>8.1f} ml  {:>7.1f} cm2  max {:.3f}  p99 {:.3f} mm\n",
                       printable(a.name), grouped_text(static_cast<long long>(a.triangles)), a.volume_ml, a.area_cm2,
                       a.deviation.max_mm, a.deviation.p99_mm);
  for (const cases::CaseMissing& a : m.missing)
    out += fmt::format("  {:<14} is missing: {}\n", printable(a.anatomy), printable(a.why));
  for (const cases::CaseStandIn& a : m.stand_ins)
    out += fmt::format("  {:<14} is {}: {}\n", printable(a.anatomy), printable(a.by), printable(a.why));
  for (const cases::CaseShape& s : m.haptic.shapes)
    out +=
        fmt::format("  felt {:<14} {:>8.1f} ml{}{}\n", printable(s.name), s.volume_ml, s.cuttable ? "  cuttable" : "",
                    s.mismatch.samples > 0 ? fmt::format("  p99 {:.2f} mm off what is seen", s.mismatch.p99_mm) : "");
  for (const cases::CaseLandmark& l : m.landmarks)
    out += fmt::format("  {:<14} {:>8.1f} {:>8.1f} {:>8.1f} mm  {} {:.2f}\n", printable(l.name), l.position_mm.x,
                       l.position_mm.y, l.position_mm.z, printable(l.source), l.confidence);
  for (const cases::CaseBurrHole& b : m.burr_holes)
    out += fmt::format("  {:<14} {:>8.1f} {:>8.1f} {:>8.1f} mm  {:.1f} mm wide\n", printable(b.name), b.position_mm.x,
                       b.position_mm.y, b.position_mm.z, b.diameter_mm);
  for (const auto& [name, value] : m.figures)
    out += fmt::format("  {}: {}\n", printable(name), printable(to_text(value)));
  for (std::size_t i = 0; i < row.warnings.size(); ++i)
    out += "  " + (i < row.severities.size() ? printable(row.severities[i]) : "warning") + ": " +
           printable(row.warnings[i]) + "\n";
  return out;
}

}  // namespace trephine::library
