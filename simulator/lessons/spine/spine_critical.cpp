// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_critical.h"

#include <algorithm>

#include "lessons/lesson_type.h"
#include "lessons/lesson_words.h"

namespace trephine::lessons {
namespace {

constexpr double side_doubt_mm = 5;  // of the middle: nearer to it a side is none
constexpr double touched_mm = 5;     // of bone, beyond a pedicle's entry: less was touched on the way to another place

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

// The tip in what is no bone, in front of the plane across the entry of the nearest pedicle: beside the vertebra.
void note_beside(const std::vector<CasePedicle>& pedicles, const NeedlePass& pass, int bone, CriticalErrors& errors,
                 const std::vector<const NeedlePass*>& at_pedicles) {
  for (const NeedlePoint& n : pass.path) {
    if (n.inside == bone || n.inside == 0) continue;
    if (std::any_of(at_pedicles.begin(), at_pedicles.end(),  // there the walls say how far it came out
                    [&](const NeedlePass* p) { return n.time_s >= p->begin_s && n.time_s <= p->end_s; }))
      continue;
    const CasePedicle* nearest = nullptr;
    for (const CasePedicle& p : pedicles)
      if (!nearest || norm(n.tip_mm - p.entry_mm) < norm(n.tip_mm - nearest->entry_mm)) nearest = &p;
    if (!nearest || nearest->confidence < sure_confidence) continue;
    errors.above("beside_spine_mm", dot(n.tip_mm - nearest->entry_mm, nearest->anterior()),
                 {"{} went past the vertebra, beside the bone", {tool_of(pass)}}, n.time_s);
  }
}

// Where the needle entered, on the other side of the middle between the pedicle that was asked for and its partner.
void note_side(const std::vector<CasePedicle>& pedicles, const SpineNeedleFacts& facts, CriticalErrors& errors) {
  const CasePedicle *asked = nullptr, *partner = nullptr;
  for (const CasePedicle& p : pedicles) {
    if (p.name == facts.task) asked = &p;
    if (number_of(p.name) == number_of(facts.task) && on_left(p.name) != on_left(facts.task)) partner = &p;
  }
  if (!asked || !partner || std::min(asked->confidence, partner->confidence) < sure_confidence) return;
  const Vec3 middle = (asked->entry_mm + partner->entry_mm) / 2, own = asked->on_left() ? asked->left : -asked->left;
  for (const NeedlePass& p : facts.punctures)
    if (dot(p.entry_mm - middle, own) < -side_doubt_mm)
      errors.happened("wrong_side", {"{} went in on the other side", {tool_of(p)}}, p.begin_s);
}

}  // namespace

void note_spine_errors(const SpineNeedleFacts& facts, const cases::CaseManifest& manifest,
                       const voxel::HapticVolume& before, double farthest_mm, CriticalErrors& errors) {
  const std::vector<CasePedicle> pedicles = pedicles_of(manifest);
  const int bone = spine_bone_of(manifest);
  std::vector<const NeedlePass*> at_pedicles;
  for (const auto* all : {&facts.punctures, &facts.passes})
    for (const NeedlePass& pass : *all)
      for (const NeedlePoint& n : pass.path)
        for (const cases::CaseShape& shape : manifest.haptic.shapes) {
          if (shape.number != n.inside) continue;
          if (shape.name == "canal")
            errors.happened("canal", {"{} entered the spinal canal", {tool_of(pass)}}, n.time_s, {{}, n.inside});
          if (is_great_vessel(shape.name))
            errors.happened("great_vessel", {"{} entered a great vessel", {tool_of(pass)}}, n.time_s, {{}, n.inside});
        }
  for (const NeedlePass& pass : facts.passes) {
    const NeedlePoint& end = pass.deepest();
    const NeedleErrors e = nearest_pedicle(pedicles, end.tip_mm, end.axis);
    if (e.entry_mm > farthest_mm) continue;
    at_pedicles.push_back(&pass);
    note_front(*e.pedicle, pass, bone, errors);
    const PedicleBreach breach = find_breach(*e.pedicle, pass, before, bone);
    errors.above("medial_breach_mm", breach.medial_mm,
                 {"{} came through the medial wall, towards the canal", {tool_of(pass)}}, breach.time_s);
    if (e.pedicle->confidence >= sure_confidence)
      errors.above("other_breach_mm", breach.other_mm,
                   {"{} came far " + ("through the " + breach.other_side + " wall"), {tool_of(pass)}}, breach.other_s);
    // Any pass, also one that was followed by the right one; but bone that was only touched was not gone into.
    if (facts.task.empty() || e.pedicle->name == facts.task) continue;
    if (&pass != &facts.passes.back() && dot(end.tip_mm - e.pedicle->entry_mm, e.pedicle->forwards()) < touched_mm)
      continue;
    errors.happened(on_left(e.pedicle->name) != on_left(facts.task) ? "wrong_side" : "wrong_level",
                    {"{} went into {}, and {} was asked for",
                     {tool_of(pass), pedicle_phrase(e.pedicle->name), pedicle_phrase(facts.task)}},
                    pass.begin_s);
  }
  for (const NeedlePass& pass : facts.punctures) note_beside(pedicles, pass, bone, errors, at_pedicles);
  if (!facts.task.empty()) note_side(pedicles, facts, errors);
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
