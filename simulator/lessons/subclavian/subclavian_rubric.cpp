// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/subclavian_rubric.h"

namespace trephine::lessons {

std::string PunctureRubric::fault() const {
  return lesson::descending_limit({{"ideal_mm", ideal_mm.limit}, {"far_mm", far_mm.limit}});
}
std::string NotchRubric::fault() const {
  if (acceptable_deg.limit > 90) return "acceptable_deg.limit: is above 90";
  return lesson::descending_limit(
      {{"ideal_deg", ideal_deg.limit}, {"good_deg", good_deg.limit}, {"acceptable_deg", acceptable_deg.limit}});
}
std::string PassesRubric::fault() const {
  return lesson::descending_limit(
      {{"ideal_count", ideal_count.limit}, {"good_count", good_count.limit}, {"most_count", most_count.limit}});
}
lesson::RubricType subclavian_rubric() { return lesson::rubric_type<SubclavianRubric>("subclavian"); }

}  // namespace trephine::lessons
