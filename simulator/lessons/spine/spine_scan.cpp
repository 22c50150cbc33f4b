// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_scan.h"

#include <fmt/format.h>

#include <optional>

#include "base/error.h"
#include "base/joined.h"
#include "lessons/scan_way.h"

namespace trephine::lessons {
namespace {

// The one that was asked for; nothing where the scan shows none there.
std::optional<lesson::OutcomeScrew> screw_for(const lesson::OutcomeRecord& record, const std::string& kind,
                                              const std::string& task) {
  std::vector<lesson::OutcomeScrew> screws;
  for (const lesson::OutcomeScrew& s : record.screws)
    if (s.kind == kind) screws.push_back(s);
  for (const lesson::OutcomeScrew& s : screws)
    if (s.pedicle == task) return s;
  if (screws.size() == 1) return screws.front();
  if (task.empty() && !screws.empty()) {
    throw Error(ExitCode::usage, "", "--task",
                "the CT shows several " + kind +
                    "s; name the pedicle of one: " + joined(screws, ", ", &lesson::OutcomeScrew::pedicle));
  }
  return {};
}

NeedlePass pass_of(const lesson::OutcomeScrew& s, const cases::LoadedCase& loaded) {
  const voxel::HapticDecoder decoder(loaded.haptic);
  const auto inside = [&](Vec3 p) { return shape_about(decoder, loaded.manifest.haptic, p); };
  NeedlePass pass;
  pass.tool = s.kind == "needle" ? s.kind : fmt::format("screw_{:.1f}x{:.0f}", s.diameter_mm, s.length_mm);
  pass.entry_mm = s.entry_mm;
  pass.axis = -s.axis;
  pass.diameter_mm = s.diameter_mm;
  pass.length_mm = s.length_mm;
  pass.in_place = true;
  const double depth = dot(s.tip_mm - s.entry_mm, s.axis);
  for (double t = 0; t < depth; t += way_step_mm) {
    const Vec3 tip = s.entry_mm + s.axis * t;
    pass.path.push_back({0, tip, pass.axis, inside(tip)});
  }
  pass.path.push_back({0, s.tip_mm, pass.axis, inside(s.tip_mm)});
  return pass;
}

}  // namespace

static std::shared_ptr<LessonFacts> facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                  const std::string& kind, const std::string& task) {
  auto facts = std::make_shared<SpineNeedleFacts>();
  facts->from_scan = true;
  facts->end = LessonEnd::finished;
  const std::optional<lesson::OutcomeScrew> screw = screw_for(record, kind, task);
  if (!screw) return facts;
  facts->seen = screw->sighting;
  if (screw->sighting != lesson::Sighting::found) return facts;
  facts->passes = {pass_of(*screw, loaded)};
  facts->punctures = facts->passes;
  return facts;
}

std::shared_ptr<LessonFacts> screw_facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                 const std::string& task) {
  return facts_of_scan(record, loaded, "screw", task);
}
std::shared_ptr<LessonFacts> needle_facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                  const std::string& task) {
  return facts_of_scan(record, loaded, "needle", task);
}

texts::Phrase unseen_in_scan(const SpineNeedleFacts& facts, bool needle) {
  if (!facts.from_scan || !facts.passes.empty()) return "";
  if (needle)
    return facts.seen == lesson::Sighting::doubtful ? "what the CT shows of a needle is doubtful"
                                                    : "the CT shows no needle there";
  return facts.seen == lesson::Sighting::doubtful ? "what the CT shows of a screw is doubtful"
                                                  : "the CT shows no screw there";
}

}  // namespace trephine::lessons
