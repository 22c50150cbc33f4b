// SPDX-License-Identifier: GPL-3.0-or-later
// The landmarks of a head judged together, and what is told of the doubtful ones.
#include <fmt/format.h>

#include <algorithm>

#include "craniometry/plausible.h"
#include "head/landmarks_parts.h"

namespace trephine::segmentation {

void lower_confidence(CaseLandmark& landmark, double factor, const std::string& reason, Reasons& reasons) {
  if (factor < 1) reasons.emplace(landmark.name, reason);
  landmark.confidence *= factor;
}

void judge_together(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons) {
  std::vector<CaseLandmark> marks = all.landmarks;
  for (CaseLandmark& m : marks)
    if (given.count(m.name)) m.source = "given";
  for (const LandmarkDoubt& doubt : implausible(marks))
    for (CaseLandmark& l : all.landmarks) {
      if (given.count(l.name)) continue;
      const bool from_nasion = l.name.rfind("kocher", 0) == 0 || (l.name == "bregma" && l.source == "estimated");
      if (l.name == doubt.name)
        lower_confidence(l, doubt.factor, doubt.reason, reasons);
      else if (doubt.name == "nasion" && from_nasion)
        lower_confidence(l, doubt.factor, "it is measured from the nasion, which is doubtful: " + doubt.reason,
                         reasons);
    }
}

void leave_out_what_is_none(HeadLandmarks& all, const std::set<std::string>& given, const Reasons& reasons,
                            Report& report) {
  const auto is_none = [&](const CaseLandmark& l) { return !given.count(l.name) && l.confidence < least_confidence; };
  for (const CaseLandmark& l : all.landmarks) {
    if (given.count(l.name) || l.confidence >= doubtful_confidence) continue;
    const auto reason = reasons.find(l.name);
    const std::string because = reason == reasons.end() ? "" : ": " + reason->second;
    report.warn(is_none(l) ? fmt::format("{} not found{}", l.name, because)
                           : fmt::format("{} is doubtful (confidence {:.2f}){}; look at it, or give it: landmarks: "
                                         "{{{}: [x, y, z]}}, mm, LPS",
                                         l.name, l.confidence, because, l.name));
  }
  all.landmarks.erase(std::remove_if(all.landmarks.begin(), all.landmarks.end(), is_none), all.landmarks.end());
}

}  // namespace trephine::segmentation
