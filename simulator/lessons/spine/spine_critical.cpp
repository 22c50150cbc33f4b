// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_critical.h"

#include <algorithm>

#include "lessons/lesson_words.h"

namespace trephine::lessons {
namespace {

texts::Phrase tool_of(const NeedlePass& pass) { return tool_phrase(pass.tool); }

bool on_left(const std::string& pedicle) { return pedicle.find("_left") != std::string::npos; }

std::string number_of(const std::string& pedicle) {
  std::string number;
  for (const char c : pedicle)
    if (c >= '0' && c <= '9') number += c;
  return number;
}

bool is_great_vessel(const std::string& shape) {
  for (const char* name : {"aorta", "vena_cava", "artery", "vein", "vessels"})
    if (shape == name) return true;
  return false;
}

// How far the tip came out of the bone again, beyond the plane of the target.
void note_front(const CasePedicle& p, const NeedlePass& pass, int bone, CriticalErrors& errors) {
  const Vec3 f = p.forwards();
  double left_at = dot(p.target_mm - p.entry_mm, f);
  for (const NeedlePoint& n : pass.path) {
    const double along = dot(n.tip_mm - p.entry_mm, f);
    if (n.inside == bone)
      left_at = std::max(left_at, along);
    else if (along > left_at)
      errors.above("anterior_cortex_mm", along - left_at,
                   {"{} came through the front of the vertebra", {tool_of(pass)}}, n.time_s);
  }
}

}  // namespace

void note_spine_errors(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                       const voxel::HapticVolume& before, double farthest_mm, CriticalErrors& errors) {
  const std::vector<CasePedicle> pedicles = pedicles_of(manifest);
  const int bone = spine_bone_of(manifest);
  for (const NeedlePass& pass : facts.passes) {
    for (const NeedlePoint& n : pass.path)
      for (const cases::CaseShape& shape : manifest.haptic.shapes) {
        if (shape.number != n.inside) continue;
        if (shape.name == "canal") errors.happened("canal", {"{} entered the spinal canal", {tool_of(pass)}}, n.time_s);
        if (is_great_vessel(shape.name))
          errors.happened("great_vessel", {"{} entered a great vessel", {tool_of(pass)}}, n.time_s);
      }
    const NeedlePoint& end = pass.path.back();
    const NeedleErrors e = nearest_pedicle(pedicles, end.tip_mm, end.axis);
    if (e.entry_mm > farthest_mm) continue;
    note_front(*e.pedicle, pass, bone, errors);
    const PedicleBreach breach = find_breach(*e.pedicle, pass, before, bone);
    errors.above("medial_breach_mm", breach.medial_mm,
                 {"{} came through the medial wall, towards the canal", {tool_of(pass)}}, breach.time_s);
  }
  if (facts.task.empty() || facts.passes.empty()) return;
  const NeedlePass& last = facts.passes.back();
  const NeedleErrors e = nearest_pedicle(pedicles, last.path.back().tip_mm, last.path.back().axis);
  if (e.entry_mm > farthest_mm || e.pedicle->name == facts.task) return;
  const bool side = on_left(e.pedicle->name) != on_left(facts.task);
  errors.happened(side ? "wrong_side" : "wrong_level",
                  {"{} went into {}, and {} was asked for",
                   {tool_of(last), pedicle_phrase(e.pedicle->name), pedicle_phrase(facts.task)}},
                  last.begin_s);
}

std::vector<std::string> pedicle_tasks(const cases::CaseManifest& manifest) {
  std::vector<CasePedicle> all = pedicles_of(manifest);
  std::stable_partition(all.begin(), all.end(), [](const CasePedicle& p) { return p.confidence >= sure_confidence; });
  std::vector<std::string> names;
  for (const CasePedicle& p : all) names.push_back(p.name);
  return names;
}

std::string pedicle_doubt(const cases::CaseManifest& manifest, const std::string& task) {
  for (const CasePedicle& p : pedicles_of(manifest))
    if (p.name == task && p.confidence < sure_confidence) return "the pedicle: " + doubt_words(p.confidence);
  return "";
}

texts::Phrase pedicle_phrase(const std::string& name) {
  const std::string number = number_of(name);
  if (name == "pedicle_" + number + "_left") return {"pedicle {} left", {number}};
  if (name == "pedicle_" + number + "_right") return {"pedicle {} right", {number}};
  return name;
}

std::string pedicle_in_words(const std::string& task, bool german) {
  const std::string number = number_of(task);
  if (german)
    return std::string("den ") + (on_left(task) ? "linken" : "rechten") + " Pedikel " + number +
           ", gezählt vom untersten Wirbel, dessen Pedikel der Scan zeigt";
  return std::string("the ") + (on_left(task) ? "left" : "right") + " pedicle " + number +
         ", counted from the lowest vertebra whose pedicles the scan shows";
}

}  // namespace trephine::lessons
