// SPDX-License-Identifier: GPL-3.0-or-later
// The head's own axes, before and after its landmarks are known.
#include <algorithm>
#include <cmath>

#include "base/degree.h"
#include "base/refusal.h"
#include "head/landmarks_parts.h"

namespace trephine::head {

const char* const how_to_give_landmarks =
    "give nasion, inion, tragus_left and tragus_right in the case's configuration (`landmarks: {nasion: [x, y, z], "
    "...}`, mm, LPS; or a `landmarks_file`, .mrk.json or .fcsv of 3D Slicer)";

HeadFrame frame_in(const MidsagittalPlane& p, const craniometry::FieldView& skull) {
  HeadFrame head;
  head.left = p.normal;
  head.back = normalized(Vec3{0, 1, 0} - p.normal * p.normal.y);
  head.up = cross(head.left, head.back);
  Vec3 sum;
  std::size_t count = 0;
  const grid::Field& f = skull.field();
  for (int k = 0; k < f.size[2]; k += 3)
    for (int j = 0; j < f.size[1]; j += 4)
      for (int i = 0; i < f.size[0]; i += 4)
        if (f.at(i, j, k) > 0) sum += f.to_world_mm({double(i), double(j), double(k)}), ++count;
  if (!count) throw refusal("skull", "is empty", {how_to_give_landmarks});
  const Vec3 middle = sum / double(count);
  head.origin_mm = middle - head.left * dot(middle - p.point_mm, head.left);
  return head;
}

void level_by_nasion(HeadFrame& head, Vec3 nasion_mm) {
  const Vec3 way = nasion_mm - head.origin_mm;
  const double angle = std::atan2(dot(way, head.up), -dot(way, head.back));
  const double turn = angle - std::clamp(angle, 0.0, 20 * degree);
  if (std::abs(turn) > 40 * degree) return;
  head.back = head.back * std::cos(turn) - head.up * std::sin(turn);
  head.up = cross(head.left, head.back);
}

}  // namespace trephine::head
