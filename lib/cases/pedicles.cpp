// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/pedicles.h"

#include <algorithm>
#include <optional>

namespace trephine::cases {
namespace {

constexpr double sure = 0.5;  // as the rubrics' least_confidence_ratio

CasePedicle pedicle_between(const std::string& name, const CaseLandmark& entry, const CaseLandmark& target) {
  CasePedicle p;
  p.name = name;
  p.entry_mm = entry.position_mm;
  p.target_mm = target.position_mm;
  p.confidence = std::min(entry.confidence, target.confidence);
  return p;
}

// A vertebra of which both pedicles are sure.
struct Vertebra {
  Vec3 middle_mm, left;
};

std::optional<Vertebra> vertebra_of(const std::vector<CasePedicle>& all, const CasePedicle& left) {
  std::string other = left.name;
  const std::size_t at = other.find("_left");
  if (at == std::string::npos) return {};
  other.replace(at, 5, "_right");
  for (const CasePedicle& right : all) {
    if (right.name != other || std::min(left.confidence, right.confidence) < sure) continue;
    const Vec3 a = (left.entry_mm + left.target_mm) / 2, b = (right.entry_mm + right.target_mm) / 2;
    if (norm(a - b) > 1) return Vertebra{(a + b) / 2, normalized(a - b)};
  }
  return {};
}

// A pedicle without a sure partner, or a vertebra without a sure neighbour, takes what the others say.
void set_axes(std::vector<CasePedicle>& all) {
  std::vector<Vertebra> vertebrae;
  for (const CasePedicle& p : all)
    if (const auto v = vertebra_of(all, p)) vertebrae.push_back(*v);
  for (CasePedicle& p : all) {
    const Vec3 at = (p.entry_mm + p.target_mm) / 2;
    const Vertebra* own = nullptr;
    for (const Vertebra& v : vertebrae)
      if (!own || norm(v.middle_mm - at) < norm(own->middle_mm - at)) own = &v;
    if (!own) continue;
    Vec3 along;  // the nearer a vertebra, the more it counts
    for (const Vertebra& v : vertebrae) {
      const Vec3 way = v.middle_mm - own->middle_mm;
      if (const double far = norm(way); far > 1) along += way * ((way.z < 0 ? -1 : 1) / (far * far));
    }
    if (norm(along) == 0) along = {0, 0, 1};
    const Vec3 cranial = along - own->left * dot(along, own->left);
    if (norm(cranial) < 1e-3 * norm(along)) continue;
    p.left = own->left;
    p.cranial = normalized(cranial);
  }
}

}  // namespace

std::vector<CasePedicle> pedicles_of(const CaseManifest& manifest) {
  const std::string entry = "_entry";
  std::vector<CasePedicle> all;
  for (const CaseLandmark& l : manifest.landmarks) {
    if (l.name.rfind("pedicle_", 0) != 0 || l.name.size() <= entry.size() ||
        l.name.compare(l.name.size() - entry.size(), entry.size(), entry) != 0)
      continue;
    const std::string name = l.name.substr(0, l.name.size() - entry.size());
    // Medial and lateral hang on the side, so a pedicle that does not say it is none.
    if (name.find("_left") == std::string::npos && name.find("_right") == std::string::npos) continue;
    for (const CaseLandmark& t : manifest.landmarks)
      if (t.name == name + "_target" && norm(t.position_mm - l.position_mm) > 1)
        all.push_back(pedicle_between(name, l, t));
  }
  set_axes(all);
  return all;
}

}  // namespace trephine::cases
