// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/ventriculostomy_rubric.h"

namespace trephine::lessons {

std::string LandmarksRubric::fault() const {
  const std::string midline =
      lesson::descending_limit({{"midline_mm", midline_mm.limit}, {"midline_near_mm", midline_near_mm.limit}});
  return midline.empty()
             ? lesson::descending_limit({{"suture_mm", suture_mm.limit}, {"suture_near_mm", suture_near_mm.limit}})
             : midline;
}
std::string BurrHoleRubric::fault() const {
  if (least_confidence_ratio.limit > 1) return "least_confidence_ratio.limit: is above 1";
  return lesson::descending_limit(
      {{"kocher_mm", kocher_mm.limit}, {"near_mm", near_mm.limit}, {"far_mm", far_mm.limit}});
}
std::string TrajectoryRubric::fault() const {
  return lesson::descending_limit(
      {{"ideal_mm", ideal_mm.limit}, {"good_mm", good_mm.limit}, {"lateral_mm", lateral_mm.limit}});
}
std::string DepthRubric::fault() const {
  return lesson::descending_limit({{"least_mm", least_mm.limit},
                                   {"low_mm", low_mm.limit},
                                   {"ideal_low_mm", ideal_low_mm.limit},
                                   {"ideal_high_mm", ideal_high_mm.limit},
                                   {"high_mm", high_mm.limit},
                                   {"most_mm", most_mm.limit}});
}
std::string TipRubric::fault() const {
  return lesson::descending_limit({{"foramen_mm", foramen_mm.limit}, {"near_mm", near_mm.limit}});
}
lesson::RubricType ventriculostomy_rubric() { return lesson::rubric_type<VentriculostomyRubric>("ventriculostomy"); }

}  // namespace trephine::lessons
