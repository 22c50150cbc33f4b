// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "segmentation/landmarks_parts.h"

namespace trephine::segmentation {
namespace {

constexpr double most_outside_mm = 30;  ///< of the skin: what a scan cut off there may still be marked

/// Calls f(distance from p in mm) for every voxel of the skin within `reach_mm` of p along each axis, until it says
/// true.
template <class F>
void for_skin(const Field& skin, Vec3 p, double reach_mm, F&& f) {
  const Vec3 c = skin.to_index(p);
  int low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    const double reach = reach_mm / skin.spacing_mm[a];
    low[a] = int(std::clamp(std::ceil(c[a] - reach), 0.0, double(skin.size[a])));
    high[a] = int(std::clamp(std::floor(c[a] + reach) + 1, 0.0, double(skin.size[a])));
  }
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i)
        if (skin.at(i, j, k) > 0) {
          const Vec3 d{(i - c.x) * skin.spacing_mm.x, (j - c.y) * skin.spacing_mm.y, (k - c.z) * skin.spacing_mm.z};
          if (f(norm(d))) return;
        }
}

bool is_near(const Field& skin, Vec3 p) {
  bool near = false;
  for_skin(skin, p, most_outside_mm, [&](double mm) { return near = mm <= most_outside_mm; });
  return near;
}

/// "tragus_left" of "left_tragus", or what is spelt nearly so.
std::string meant(const std::string& name) {
  const auto words = [](const std::string& s) {
    std::multiset<std::string> all;
    for (std::size_t at = 0, end; at <= s.size(); at = end + 1) {
      end = std::min(s.find('_', at), s.size());
      all.insert(s.substr(at, end - at));
    }
    return all;
  };
  for (const std::string& known : findable_landmarks())
    if (words(known) == words(name)) return known;
  return nearest_name(name, findable_landmarks());
}

}  // namespace

void check_given(const std::vector<CaseLandmark>& given, const Field& skin, Report& report) {
  std::set<std::string> names;
  const std::vector<std::string>& known = findable_landmarks();
  for (const CaseLandmark& l : given) {
    if (!is_finite(l.position_mm)) throw Error(ExitCode::bad_input, "", l.name, "is not finite");
    if (!names.insert(l.name).second) throw Error(ExitCode::bad_input, "", l.name, "is given twice");
    if (!is_near(skin, l.position_mm)) {
      double mm = 1e300;
      for_skin(skin, l.position_mm, 1e9, [&](double d) {
        mm = std::min(mm, d);
        return false;
      });
      const Vec3 p = l.position_mm;
      throw Error(ExitCode::bad_input, "", l.name,
                  fmt::format("({:.1f}, {:.1f}, {:.1f}) mm, lies {:.0f} mm outside of the skin, at most {:.0f}{}", p.x,
                              p.y, p.z, mm, most_outside_mm,
                              is_near(skin, {-p.x, -p.y, p.z})
                                  ? ": with x and y negated it would not, RAS was taken for LPS or the reverse"
                                  : ": is it of another scan?"));
    }
    if (std::find(known.begin(), known.end(), l.name) != known.end()) continue;
    const std::string near = meant(l.name);
    report.warn(printable(l.name) + " is none of the landmarks that are looked for" +
                (near.empty() ? ": it is kept as it is" : ", did you mean " + near + "?"));
  }
}

}  // namespace trephine::segmentation
