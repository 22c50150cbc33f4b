// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/pedicles.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "head/head_landmarks.h"
#include "stages/stage.h"

namespace trephine::stages {
namespace {

struct PedicleFigures {
  double half_width_mm = 0, confidence = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&PedicleFigures::half_width_mm, "half_width_mm", Range{}, "From its axis to the wall.");
    v.number(&PedicleFigures::confidence, "confidence", Range{}, "How sure it is, 0 to 1.");
  }
};

/// Of the pedicles that were found, and of all with those that were given.
struct PediclesResult {
  trunk::PediclesFound found;
  Named<PedicleFigures> pedicles;
  template <class V>
  static void describe(V& v) {
    v.all_of(&PediclesResult::found);
    v.map(&PediclesResult::pedicles, "pedicles", "Each pedicle.").items_joined("_");
  }
};

std::string name_of(const trunk::PedicleAxis& p) {
  return fmt::format("pedicle_{}_{}", p.vertebra, p.left ? "left" : "right");
}

// Points that a person gave take the place of found ones; the half-width is measured anew.
void take_given(const grid::Field& bone, const std::vector<cases::CaseLandmark>& given,
                std::vector<trunk::PedicleAxis>& all, std::map<std::string, bool>& is_given, Warnings& warnings) {
  std::map<std::string, trunk::PedicleAxis> by_name;
  for (const trunk::PedicleAxis& p : all) by_name[name_of(p)] = p;
  std::map<std::string, int> ends;  // bit 0 the entry, bit 1 the target
  for (const cases::CaseLandmark& l : given) {
    const std::vector<std::string> words = split_at(l.name, '_');
    const bool entry = words.size() == 4 && words[3] == "entry", target = words.size() == 4 && words[3] == "target";
    const std::int64_t vertebra = words.size() == 4 ? parse_integer(words[1]).value_or(0) : 0;
    if (words[0] != "pedicle" || (!entry && !target) || vertebra < 1 || vertebra > 26 ||
        (words[2] != "left" && words[2] != "right")) {
      warnings.push_back({"unknown_landmark",
                          "{landmark} is none of the landmarks that are looked for: it is not kept",
                          {{"landmark", printable(l.name)}}});
      continue;
    }
    if (!is_finite(l.position_mm)) throw head::landmark_fault(l.name, "is not finite");
    const std::string name = l.name.substr(0, l.name.rfind('_'));
    trunk::PedicleAxis& p = by_name[name];
    p.vertebra = int(vertebra);
    p.left = words[2] == "left";
    (entry ? p.entry_mm : p.target_mm) = l.position_mm;
    ends[name] |= entry ? 1 : 2;
  }
  for (const auto& end : ends) {
    const std::string& name = end.first;
    const int which = end.second;
    trunk::PedicleAxis& p = by_name[name];
    const bool was_found =
        std::any_of(all.begin(), all.end(), [&](const trunk::PedicleAxis& f) { return name_of(f) == name; });
    if (which != 3 && !was_found)
      throw Error(ExitCode::bad_input, "", name, "was not found, so both its entry and its target must be given");
    const double length = norm(p.target_mm - p.entry_mm);
    if (!(length >= 10 && length <= 100))
      throw Error(ExitCode::bad_input, "", name,
                  fmt::format("entry and target as given are {:.0f} mm apart, of a pedicle 10 to 100", length));
    p.middle_mm = p.entry_mm + (p.target_mm - p.entry_mm) * 0.4;
    p.half_width_mm = std::max(0.0, trunk::clearance_along(bone, p.entry_mm, p.target_mm));
    if (p.half_width_mm == 0)
      warnings.push_back(
          {"given_leaves_bone", "{pedicle} as given leaves the bone between entry and body", {{"pedicle", name}}});
    // Of a pedicle of which one end alone was given, the other one is as sure as it was found.
    if (which & 1) is_given[name + "_entry"] = true;
    if (which & 2) is_given[name + "_target"] = true;
    if (which != 3) continue;
    p.confidence = 1;
    p.doubt.clear();
  }
  all.clear();
  for (const auto& [name, p] : by_name) all.push_back(p);
  std::sort(all.begin(), all.end(), [](const trunk::PedicleAxis& a, const trunk::PedicleAxis& b) {
    return a.vertebra != b.vertebra ? a.vertebra < b.vertebra : a.left && !b.left;
  });
}

}  // namespace

StageType pedicles_stage() {
  StageType s;
  s.name = "pedicles";
  s.version = 7;
  s.typical.base_s = 0.2;
  s.typical.per_million_voxels_s = 0.055;
  s.place = StagePlace::scan;
  s.summary = "finds the pedicles of a spine and the axis of each";
  s.description =
      "Finds the pedicles beside the spinal canal, and for each the line of largest clearance through it: its entry "
      "behind, its target in the body, and its half-width. The landmarks are pedicle_N_left_entry, "
      "pedicle_N_left_target and so on the right; N counts the vertebrae from the lowest whose pedicles the scan "
      "shows, and names no level, because neither sacrum nor ribs are looked for. One that the scan's end cuts is left "
      "out; one with a confidence below 0.5 is warned of, with the reason. A given landmark replaces the found one, "
      "and "
      "the half-width is measured anew.";
  s.examples = {"trephine pedicles volume.nrrd --bone bone.nrrd --canal canal.nrrd --output landmarks.json",
                "trephine pedicles volume.nrrd --bone bone.nrrd --canal canal.nrrd --given points.mrk.json --output "
                "landmarks.json"};
  s.ports = {port("volume", DataKind::volume).from(From::original_scan).help("CT volume in HU, in axial slices"),
             port("bone", DataKind::field).help("the spine's bone, filled"),
             port("canal", DataKind::field).help("the spinal canal"),
             port("given", DataKind::landmarks)
                 .from(From::given_landmarks)
                 .optional()
                 .help("landmarks that a person placed; they replace found ones")};
  s.points = {{"pedicle", picture::SlicePlane::axial, true}};
  s.output = DataKind::landmarks;
  s.declares<trunk::PediclesParams, PediclesResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const grid::Field& bone = *in.get<grid::Field>("bone");
    grid::place_in(bone, grid::lattice_of(*in.get<grid::HuVolume>("volume")));
    const auto* given = in.get<head::HeadLandmarks>("given");
    const bool some_given =
        given && std::any_of(given->landmarks.begin(), given->landmarks.end(),
                             [](const cases::CaseLandmark& l) { return l.name.rfind("pedicle_", 0) == 0; });
    auto found = trunk::find_pedicles(bone, *in.get<grid::Field>("canal"), params.as<trunk::PediclesParams>(), progress,
                                      some_given);
    std::vector<trunk::PedicleAxis>& all = found.value;
    Outcome<head::HeadLandmarks, PediclesResult> out{{}, {found.result, {}}, std::move(found.warnings)};
    std::map<std::string, bool> is_given;
    if (given) take_given(bone, given->landmarks, all, is_given, out.warnings);
    for (const trunk::PedicleAxis& p : all) {
      const std::string name = name_of(p);
      const auto add = [&](const std::string& end, Vec3 at) {
        const bool given = is_given[end];
        out.value.landmarks.push_back({end, at, given ? 1.0 : p.confidence, given ? "given" : "found"});
      };
      add(name + "_entry", p.entry_mm);
      add(name + "_target", p.target_mm);
      out.result.pedicles.emplace_back(name, PedicleFigures{p.half_width_mm, p.confidence});
      if (p.confidence < 0.5)
        out.warnings.push_back({"pedicle_doubtful",
                                "{pedicle} is doubtful (confidence {confidence:.2f}): {reason}",
                                {{"pedicle", name}, {"confidence", p.confidence}, {"reason", p.doubt}}});
    }
    return stage_outcome(std::move(out));
  };
  return s;
}

}  // namespace trephine::stages
