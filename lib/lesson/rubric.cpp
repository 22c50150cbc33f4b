// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/rubric.h"

#include <utility>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "lesson/declared_json.h"

namespace trephine {
namespace {

constexpr int compiled_version = 1;

// The name of the first limit that is below the one before it.
std::string descending(const std::vector<std::pair<const char*, double>>& limits) {
  for (std::size_t n = 1; n < limits.size(); ++n)
    if (limits[n].second < limits[n - 1].second)
      return std::string(limits[n].first) + ".limit: is below " + limits[n - 1].first;
  return "";
}

// The rubric as it lies in the compiled file.
struct CompiledFile {
  int trephine_rubric = 0;
  std::string sha256;
  VentriculostomyRubric rubric;
  template <class V>
  static void describe(V& v) {
    using P = CompiledFile;
    v.integer(&P::trephine_rubric, "trephine_rubric", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::sha256, "sha256", "SHA-256 of the rubric's JSON without blanks.").is_required();
    v.group(&P::rubric, "rubric", "The rubric.").is_required();
  }
};

std::string digest_of(const VentriculostomyRubric& rubric) {
  return sha256_of_bytes(declared_json(AnyParams::make<VentriculostomyRubric>(rubric), -1));
}

}  // namespace

std::string LandmarksRubric::fault() const {
  const std::string midline =
      descending({{"midline_mm", midline_mm.limit}, {"midline_near_mm", midline_near_mm.limit}});
  return midline.empty() ? descending({{"suture_mm", suture_mm.limit}, {"suture_near_mm", suture_near_mm.limit}})
                         : midline;
}
std::string BurrHoleRubric::fault() const {
  if (least_confidence_ratio.limit > 1) return "least_confidence_ratio.limit: is above 1";
  return descending({{"kocher_mm", kocher_mm.limit}, {"near_mm", near_mm.limit}, {"far_mm", far_mm.limit}});
}
std::string TrajectoryRubric::fault() const {
  return descending({{"ideal_mm", ideal_mm.limit}, {"good_mm", good_mm.limit}, {"lateral_mm", lateral_mm.limit}});
}
std::string DepthRubric::fault() const {
  return descending({{"least_mm", least_mm.limit},
                     {"low_mm", low_mm.limit},
                     {"ideal_low_mm", ideal_low_mm.limit},
                     {"ideal_high_mm", ideal_high_mm.limit},
                     {"high_mm", high_mm.limit},
                     {"most_mm", most_mm.limit}});
}
std::string TipRubric::fault() const {
  return descending({{"foramen_mm", foramen_mm.limit}, {"near_mm", near_mm.limit}});
}
std::string TimeRubric::fault() const {
  return descending({{"ideal_s", ideal_s.limit},
                     {"good_s", good_s.limit},
                     {"acceptable_s", acceptable_s.limit},
                     {"allotted_s", allotted_s.limit}});
}

std::string compile_rubric(const VentriculostomyRubric& rubric) {
  return declared_json(AnyParams::make<CompiledFile>({compiled_version, digest_of(rubric), rubric})) + "\n";
}

CompiledRubric read_rubric(std::string_view json) {
  CompiledFile file;
  read_declared_json(json, parameters_of<CompiledFile>(), &file);
  if (digest_of(file.rubric) != file.sha256)
    throw Error(ExitCode::bad_input, "", "sha256", "the rubric was changed after `trephine rubric` compiled it");
  return {file.rubric, file.sha256};
}

}  // namespace trephine
