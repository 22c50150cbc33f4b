// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/outcome_picture.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "cases/pedicles.h"
#include "outcome/line.h"
#include "picture/slice.h"

namespace trephine::outcome {
namespace {

constexpr int side_px = 520;
constexpr double near_slice_mm = 3;  ///< what lies farther off is drawn fainter
using Rgb = picture::Rgb;
constexpr Rgb course_rgb{1, 0.55, 0.1}, other_rgb{0.9, 0.3, 0.9}, hole_rgb{0.25, 0.75, 1}, target_rgb{1, 0.2, 0.2},
    ideal_rgb{0.3, 1, 0.4};
constexpr std::size_t most_screws = 6;

void dot_at(picture::Image& image, double x, double y, double radius, const Rgb& colour, double share) {
  for (int j = int(y - radius - 1); j <= int(y + radius + 1); ++j)
    for (int i = int(x - radius - 1); i <= int(x + radius + 1); ++i) {
      if (i < 0 || j < 0 || i >= image.width || j >= image.height) continue;
      const double cover = share * std::clamp(radius + 0.5 - std::hypot(i + 0.5 - x, j + 0.5 - y), 0.0, 1.0);
      std::uint8_t* p = image.at(i, j);
      for (int c = 0; c < 3; ++c)
        p[c] = std::uint8_t(std::lround(p[c] * (1 - cover) + 255 * colour[std::size_t(c)] * cover));
    }
}

class Sheet {
 public:
  Sheet(const cases::LoadedCase& loaded, const lesson::OutcomeRecord& record) : volume_(loaded.ct), record_(record) {
    for (const cases::CaseTarget& t : loaded.manifest.targets)
      if (t.name == "monro_left" || t.name == "monro_right") targets_.push_back(t.position_mm);
    if (!record.screws.empty()) pedicles_ = cases::pedicles_of(loaded.manifest);
  }
  picture::Image through(Vec3 p, picture::SlicePlane plane, const std::string& note) const {
    picture::SliceParams params;
    params.plane = plane;
    params.longer_side_px = side_px;
    params.window_center_hu = 100, params.window_width_hu = 500;
    if (!record_.screws.empty()) params.window_center_hu = 400, params.window_width_hu = 1600;
    const int axis = picture::axis_of(plane);
    const auto range = picture::slice_range_mm(grid::lattice_of(volume_), plane);
    params.position_mm = std::clamp(p[axis], range[0] + 1e-6, range[1] - 1e-6);
    params.note = note;
    picture::Image image = picture::slice_overlay(volume_, params, {});
    const picture::SliceGeometry at = picture::slice_geometry(grid::lattice_of(volume_), params);
    const auto draw = [&](Vec3 q, double radius, const Rgb& colour) {
      const Vec3 d = q - at.corner_mm;
      const double share = std::abs(q[axis] - params.position_mm) <= near_slice_mm ? 1 : 0.35;
      dot_at(image, dot(d, at.right) / at.mm_per_px, dot(d, at.down) / at.mm_per_px, radius, colour, share);
    };
    for (const lesson::OutcomeHole& h : record_.holes) {
      const Vec3 a = perpendicular_to(h.out), b = cross(h.out, a);
      for (int n = 0; n < 180; ++n)
        draw(h.outer_mm + (a * std::cos(2 * pi * n / 180) + b * std::sin(2 * pi * n / 180)) * (h.diameter_mm / 2), 1.1,
             hole_rgb);
    }
    for (const lesson::OutcomeOpening& o : record_.openings)
      for (const lesson::OutcomePlace& p : o.border) draw(p.at_mm, 2, hole_rgb);
    for (std::size_t c = record_.courses.size(); c-- > 0;) {
      const lesson::OutcomeCourse& course = record_.courses[c];
      for (std::size_t n = 0; n + 1 < course.course.size(); ++n)
        for (int part = 0; part < 12; ++part)
          draw(course.course[n].at_mm * (1 - part / 12.0) + course.course[n + 1].at_mm * (part / 12.0), 1.2,
               c == 0 ? course_rgb : other_rgb);
      draw(course.tip_mm, 3.5, c == 0 ? course_rgb : other_rgb);
    }
    const auto line = [&](Vec3 a, Vec3 b, double radius, const Rgb& colour) {
      const int parts = int(norm(b - a) / 0.3) + 1;
      for (int n = 0; n <= parts; ++n) draw(a + (b - a) * (double(n) / parts), radius, colour);
    };
    for (const cases::CasePedicle& p : pedicles_) line(p.entry_mm, p.target_mm, 0.8, ideal_rgb);
    for (const lesson::OutcomeScrew& s : record_.screws) {
      const Rgb& colour = s.sighting == lesson::Sighting::found ? course_rgb : other_rgb;
      const Vec3 a = perpendicular_to(s.axis), b = cross(s.axis, a);
      for (int n = 0; n < 6; ++n) {  // its side, and its axis
        const Vec3 off = (a * std::cos(2 * pi * n / 6) + b * std::sin(2 * pi * n / 6)) * (0.5 * s.diameter_mm);
        line(s.head_mm + off, s.tip_mm + off, 0.5, colour);
      }
      line(s.head_mm, s.tip_mm, 0.8, colour);
      draw(s.tip_mm, 3, colour);
    }
    for (const lesson::OutcomeLine& l : record_.lines) {
      const Rgb& colour = l.sighting == lesson::Sighting::found ? course_rgb : other_rgb;
      for (std::size_t n = 0; n + 1 < l.course.size(); ++n) line(l.course[n].at_mm, l.course[n + 1].at_mm, 0.8, colour);
      draw(l.tip_mm, 3, colour);
      draw(l.vein_mm, 2, hole_rgb);
    }
    for (const Vec3& t : targets_)
      for (int n = 0; n < 60; ++n)
        draw(t + at.right * (4 * std::cos(2 * pi * n / 60)) + at.down * (4 * std::sin(2 * pi * n / 60)), 0.8,
             target_rgb);
    return image;
  }

 private:
  grid::HuVolume volume_;
  const lesson::OutcomeRecord& record_;
  std::vector<Vec3> targets_;
  std::vector<cases::CasePedicle> pedicles_;
};

}  // namespace

picture::Image outcome_picture(const cases::LoadedCase& loaded, const lesson::OutcomeRecord& record) {
  if (!loaded.has_ct() || (record.courses.empty() && record.holes.empty() && record.openings.empty() &&
                           record.screws.empty() && record.lines.empty()))
    return {};
  const Sheet sheet(loaded, record);
  std::vector<picture::Image> cells;
  using picture::SlicePlane;
  for (std::size_t n = 0; n < std::min(most_screws, record.screws.size()); ++n) {
    const lesson::OutcomeScrew& s = record.screws[n];
    for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal})
      cells.push_back(sheet.through(s.head_mm * 0.5 + s.tip_mm * 0.5, plane, s.pedicle));
  }
  for (const lesson::OutcomeLine& l : record.lines)
    for (const Vec3& p : {l.vein_mm, l.tip_mm})
      for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal})
        cells.push_back(sheet.through(p, plane, l.side));
  if (!record.courses.empty())
    for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal})
      cells.push_back(sheet.through(record.courses.front().tip_mm, plane, "tip of the course"));
  if (!record.holes.empty())
    for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal})
      cells.push_back(sheet.through(record.holes.front().outer_mm, plane, "hole"));
  if (!record.openings.empty())
    for (const SlicePlane plane : {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal})
      cells.push_back(sheet.through(record.openings.front().middle_mm, plane, "opening"));
  return picture::contact_sheet(cells, 3);
}

}  // namespace trephine::outcome
