// SPDX-License-Identifier: GPL-3.0-or-later
#include "page/page_notes.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::page {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t max_json_bytes = std::uint64_t{16} << 20;
constexpr std::string_view deviation_magic = "trephine deviation 1\n";
constexpr std::size_t hash_digits = 64;

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::bad_input, "", "", what); }

std::uint32_t bits_of(float v) {
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return std::isnan(v) ? 0x7fc00000u : bits;  // one NaN, whatever its payload
}

// The file's JSON; nothing where there is none.
Json read_json(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  const std::vector<char> bytes = read_file(file, max_json_bytes);
  try {
    return Json::parse(bytes.begin(), bytes.end());
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::bad_input, file.string(), "", "is damaged; run the case again, or remove the file");
  }
}

PageTrade read_trade(const Json& json) {
  PageTrade trade;
  trade.chosen = json.at("chosen").get<std::string>();
  trade.rule = json.at("rule").get<std::string>();
  trade.why = json.at("why").get<std::string>();
  for (const Json& p : json.at("points"))
    trade.points.push_back({p.at("name").get<std::string>(), p.at("seconds").get<double>(),
                            p.at("deviation_rms_mm").get<double>(), p.at("triangles_count").get<std::int64_t>(),
                            p.value("refused", std::string())});
  return trade;
}

}  // namespace

std::string deviation_file_name(const cases::CaseManifest& manifest, const cases::CaseAnatomy& anatomy) {
  return "deviation-" + anatomy.name + "-" + manifest.find_file(anatomy.file)->sha256.substr(0, 16) + ".f32";
}

std::string encode_deviation(const std::vector<float>& deviation_mm) {
  std::string values;
  values.reserve(deviation_mm.size() * 4);
  for (const float v : deviation_mm)
    for (int shift = 0; shift < 32; shift += 8) values += static_cast<char>(bits_of(v) >> shift & 0xff);
  return std::string(deviation_magic) + sha256_of_bytes(values) + "\n" + values;
}

std::vector<float> decode_deviation(std::string_view bytes, std::uint64_t points) {
  const std::size_t header = deviation_magic.size() + hash_digits + 1;
  if (bytes.substr(0, deviation_magic.size()) != deviation_magic || bytes.size() < header)
    refuse("is no file of deviations");
  const std::string_view values = bytes.substr(header);
  if (sha256_of_bytes(values) != bytes.substr(deviation_magic.size(), hash_digits)) refuse("its checksum is wrong");
  if (values.size() != points * 4)
    refuse("holds " + std::to_string(values.size() / 4) + " values, the surface has " + std::to_string(points) +
           " points");
  std::vector<float> out(points);
  for (std::size_t i = 0; i < points; ++i) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 4; ++b) bits |= std::uint32_t{static_cast<unsigned char>(values[4 * i + b])} << 8 * b;
    std::memcpy(&out[i], &bits, sizeof bits);
  }
  return out;
}

std::string page_notes_json(const PageNotes& notes) {
  Json json;
  json["warnings"] = json["severities"] = Json::array();
  for (const PageWarning& w : notes.warnings) {
    json["warnings"].push_back(w.text);
    json["severities"].push_back(w.severity);
  }
  if (!notes.trade.points.empty()) {
    Json& trade =
        json["trade"] = {{"rule", notes.trade.rule}, {"chosen", notes.trade.chosen}, {"why", notes.trade.why}};
    for (const PageTrade::Point& p : notes.trade.points) {
      Json point = {{"name", p.name},
                    {"seconds", p.seconds},
                    {"deviation_rms_mm", p.deviation_rms_mm},
                    {"triangles_count", p.triangles_count}};
      if (!p.refused.empty()) point["refused"] = p.refused;
      trade["points"].push_back(std::move(point));
    }
  }
  return json.dump(1) + "\n";
}

PageNotes read_page_notes(const fs::path& case_folder, const cases::CaseManifest& manifest) {
  PageNotes notes;
  const fs::path report = case_folder / "report";
  Json json = read_json(report / page_notes_file);
  const fs::path from = json.is_null() ? case_folder / "run.json" : report / page_notes_file;
  if (json.is_null()) json = read_json(from);
  try {
    if (!json.is_null())
      for (std::size_t i = 0; i < json.at("warnings").size(); ++i)
        notes.warnings.push_back(
            {json.at("warnings").at(i).get<std::string>(),
             json.contains("severities") ? json.at("severities").at(i).get<std::string>() : "look"});
    if (json.contains("trade")) notes.trade = read_trade(json.at("trade"));
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::bad_input, from.string(), "", "is not what `run` writes; run the case again, or remove it");
  }
  for (const cases::CaseAnatomy& a : manifest.anatomies) {
    std::error_code ignored;
    if (a.file.empty()) continue;
    const fs::path file = report / deviation_file_name(manifest, a);
    if (!fs::exists(file, ignored)) continue;
    const std::vector<char> bytes = read_file(file);
    notes.deviation_mm[a.name] = with_file(file.string(), [&] {
      return decode_deviation({bytes.data(), bytes.size()}, a.points);
    });
  }
  return notes;
}

}  // namespace trephine::page
