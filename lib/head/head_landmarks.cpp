// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/head_landmarks.h"

#include <cmath>
#include <cstdint>
#include <set>

#include "base/write_file.h"
#include "cases/slicer_points.h"
#include "json/json_at.h"

namespace trephine::head {
namespace {

using json::Json;
using json::JsonAt;

constexpr std::uint64_t max_bytes = 4 << 20;

Json value_of(Vec3 p) { return Json::array({p.x, p.y, p.z}); }

Vec3 vector_in(const JsonAt& at) {
  const std::vector<double> v = at.numbers(3);
  return {v[0], v[1], v[2]};
}

double share_in(const JsonAt& at) {
  const double share = at.number();
  if (share < 0 || share > 1) at.refuse("must be a number from 0 to 1");
  return share;
}

// Of the sources that a case may name.
std::string source_in(const JsonAt& at) {
  const std::string source = at.text();
  for (const char* known : {"found", "estimated", "given", "truth"})
    if (source == known) return source;
  at.refuse("must be found, estimated, given or truth");
}

}  // namespace

const cases::CaseLandmark* HeadLandmarks::find(std::string_view name) const {
  for (const cases::CaseLandmark& l : landmarks)
    if (l.name == name) return &l;
  return nullptr;
}

const std::vector<std::string>& findable_landmarks() {
  static const std::vector<std::string> names{"nasion",      "inion",        "vertex",     "bregma",
                                              "tragus_left", "tragus_right", "monro_left", "monro_right",
                                              "kocher_left", "kocher_right"};
  return names;
}

std::string landmarks_json(const HeadLandmarks& landmarks) {
  Json j;
  j["midsagittal"] = {{"point_mm", value_of(landmarks.midsagittal.point_mm)},
                      {"normal", value_of(landmarks.midsagittal.normal)},
                      {"confidence", landmarks.midsagittal.confidence}};
  j["landmarks"] = Json::array();
  for (const cases::CaseLandmark& l : landmarks.landmarks)
    j["landmarks"].push_back({{"name", l.name},
                              {"position_mm", value_of(l.position_mm)},
                              {"confidence", l.confidence},
                              {"source", l.source}});
  return j.dump(2) + "\n";
}

HeadLandmarks parse_landmarks_json(std::string_view text) {
  const Json parsed = json::parse_json(text);
  const JsonAt root(parsed, "");
  HeadLandmarks out;
  const JsonAt plane = root["midsagittal"];
  out.midsagittal = {vector_in(plane["point_mm"]), vector_in(plane["normal"]), share_in(plane["confidence"])};
  if (std::abs(norm(out.midsagittal.normal) - 1) > 1e-6) plane["normal"].refuse("must be of length 1");
  std::set<std::string> names;
  for (const JsonAt& item : root["landmarks"].items()) {
    out.landmarks.push_back(
        {item["name"].text(), vector_in(item["position_mm"]), share_in(item["confidence"]), source_in(item["source"])});
    if (!names.insert(out.landmarks.back().name).second) item["name"].refuse("is there twice");
  }
  return out;
}

HeadLandmarks read_head_landmarks(const std::filesystem::path& file, ExitCode other_ending) {
  const std::string name = file.filename().string();
  const auto ends = [&](const std::string& end) {
    return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
  };
  const bool table = ends(".fcsv"), markups = ends(".mrk.json");
  if (!table && !markups && !ends(".json"))
    throw Error(other_ending, file.string(), "landmarks", "must end in .mrk.json, .fcsv, or .json for our own");
  const std::vector<char> bytes = read_file(file, max_bytes);
  const std::string_view text(bytes.data(), bytes.size());
  return with_file(file.string(), [&] {
    HeadLandmarks points;
    if (!table && !markups) return parse_landmarks_json(text);
    points.landmarks = table ? cases::parse_slicer_fcsv(text) : cases::parse_slicer_markups(text);
    return points;
  });
}

std::vector<cases::CaseLandmark> read_landmark_file(const std::filesystem::path& file) {
  return read_head_landmarks(file, ExitCode::usage).landmarks;
}

}  // namespace trephine::head
