// SPDX-License-Identifier: GPL-3.0-or-later
// The landmarks of a head judged together, and what is told of the doubtful ones.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "craniometry/plausible.h"
#include "head/landmarks_parts.h"

namespace trephine::head {
namespace {
constexpr double of_a_lone_tragus = 0.45, of_a_lone_foramen = 0.65;
}

void lower_confidence(cases::CaseLandmark& landmark, double factor, const std::string& reason, Reasons& reasons) {
  reasons.note(landmark.name, factor, reason);
  landmark.confidence *= factor;
}

void judge_tragi(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons) {
  const std::array<const char*, 2> names{"tragus_left", "tragus_right"};
  std::array<std::string, 2> against;  // why the other one does not confirm it
  for (int s = 0; s < 2; ++s) {
    const cases::CaseLandmark* other = all.find(names[1 - s]);
    const char* side = s == 0 ? "right" : "left";
    if (!other)
      against[s] = fmt::format("the other one, on the {}, was not found, and nothing confirms it", side);
    else if (!given.count(other->name) && other->confidence < doubtful_confidence)
      against[s] =
          fmt::format("the other one, on the {}, is itself doubtful (confidence {:.2f}) and does not confirm it", side,
                      other->confidence);
  }
  for (cases::CaseLandmark& l : all.landmarks)
    for (int s = 0; s < 2; ++s)
      if (l.name == names[s] && !against[s].empty() && !given.count(l.name) && l.confidence >= doubtful_confidence)
        lower_confidence(l, of_a_lone_tragus, against[s], reasons);
}

void judge_foramina(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons) {
  const std::array<const char*, 2> names{"monro_left", "monro_right"};
  std::array<bool, 2> sure{false, false};
  for (int s = 0; s < 2; ++s)
    if (const cases::CaseLandmark* l = all.find(names[s]))
      sure[s] = given.count(names[s]) || l->confidence >= doubtful_confidence;
  for (cases::CaseLandmark& l : all.landmarks)
    for (int s = 0; s < 2; ++s)
      if (l.name == names[s] && sure[s] && !sure[1 - s] && !given.count(l.name))
        lower_confidence(l, of_a_lone_foramen, "the other foramen is doubtful or missing and does not confirm it",
                         reasons);
}

void judge_together(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons) {
  std::vector<cases::CaseLandmark> marks = all.landmarks;
  for (cases::CaseLandmark& m : marks)
    if (given.count(m.name)) m.source = "given";
  for (const craniometry::LandmarkDoubt& doubt : craniometry::implausible(marks))
    for (cases::CaseLandmark& l : all.landmarks) {
      if (given.count(l.name)) continue;
      const bool from_nasion = l.name.rfind("kocher", 0) == 0 || (l.name == "bregma" && l.source == "estimated");
      if (l.name == doubt.name)
        lower_confidence(l, doubt.factor, doubt.reason, reasons);
      else if (doubt.name == "nasion" && from_nasion)
        lower_confidence(l, doubt.factor, "it is measured from the nasion, which is doubtful: " + doubt.reason,
                         reasons);
    }
  judge_tragi(all, given, reasons);
  judge_foramina(all, given, reasons);
}

Warnings leave_out_what_is_none(HeadLandmarks& all, const std::set<std::string>& given, const Reasons& reasons) {
  Warnings warnings;
  const auto is_none = [&](const cases::CaseLandmark& l) {
    return !given.count(l.name) && l.confidence < min_confidence;
  };
  for (const cases::CaseLandmark& l : all.landmarks) {
    if (given.count(l.name) || l.confidence >= doubtful_confidence) continue;
    const std::string& reason = reasons.of(l.name);
    const std::string because = reason.empty() ? "" : ": " + reason;
    if (is_none(l))
      warnings.push_back(
          {"landmark_not_found", "{landmark} not found{because}", {{"landmark", l.name}, {"because", because}}});
    else
      warnings.push_back({"landmark_doubtful",
                          "{landmark} is doubtful (confidence {confidence:.2f}){because}; look at it, or give it in "
                          "the case's configuration: landmarks: {{{landmark}: [x, y, z]}}, mm, LPS",
                          {{"landmark", l.name}, {"confidence", l.confidence}, {"because", because}}});
  }
  all.landmarks.erase(std::remove_if(all.landmarks.begin(), all.landmarks.end(), is_none), all.landmarks.end());
  return warnings;
}

}  // namespace trephine::head
