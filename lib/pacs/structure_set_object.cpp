// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "pacs/anatomy_codes.h"
#include "pacs/contours.h"
#include "pacs/object.h"
#include "pacs/tags.h"

namespace trephine::pacs {
namespace {

// The points to 0.001 mm, without repetitions; fewer than three are no contour.
std::vector<Vec3> points_of(const PlaneLine& line, const SliceSet& slices, std::size_t slice) {
  std::vector<Vec3> points;
  for (const PlanePoint& p : line) {
    Vec3 q = slices.origins_mm[slice] + slices.u * p.x + slices.v * p.y;
    for (int a = 0; a < 3; ++a) q[a] = std::round(q[a] * 1000) / 1000 + 0.0;
    if (points.empty() || q != points.back()) points.push_back(q);
  }
  while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  if (points.size() < 3) points.clear();
  return points;
}

std::string data_of(const std::vector<Vec3>& points) {
  std::string text;
  for (const Vec3& p : points) text += fmt::format("{}{:.3f}\\{:.3f}\\{:.3f}", text.empty() ? "" : "\\", p.x, p.y, p.z);
  return text;
}

Elements image_item(const SliceSet& slices, std::size_t slice) {
  Elements e;
  e.text(t_referenced_class, "UI", slices.class_uid).text(t_referenced_uid, "UI", slices.images[slice].instance_uid);
  if (slices.images[slice].frame > 0) e.text(t_referenced_frame, "IS", std::to_string(slices.images[slice].frame));
  return e;
}

std::vector<Elements> contours_of(const ContouredSurface& s, const SliceSet& slices, const Progress& progress) {
  std::vector<std::vector<Elements>> by_slice(slices.origins_mm.size());
  parallel_for(0, std::int64_t(by_slice.size()), 1, [&](std::int64_t at, std::int64_t) {
    progress.check();
    const auto k = std::size_t(at);
    for (const PlaneLine& line : with_keyholes(contours_on(*s.mesh, slices, k))) {
      const std::vector<Vec3> points = points_of(line, slices, k);
      if (points.empty()) continue;
      Elements e;
      if (!slices.images.empty()) e.item(t_contour_image, image_item(slices, k));
      e.text(t_contour_type, "CS", "CLOSED_PLANAR")
          .text(t_contour_points, "IS", std::to_string(points.size()))
          .text(t_contour_data, "DS", data_of(points));
      by_slice[k].push_back(std::move(e));
    }
  });
  std::vector<Elements> all;
  for (auto& slice : by_slice)
    for (Elements& e : slice) all.push_back(std::move(e));
  return all;
}

Elements frame_of_reference(const CaseIdentity& identity, const SliceSet& slices) {
  Elements e;
  e.text(t_frame_uid, "UI", identity.frame_uid);
  if (slices.images.empty()) return e;
  std::vector<Elements> images;
  for (std::size_t k = 0; k < slices.images.size(); ++k) images.push_back(image_item(slices, k));
  Elements series;
  series.text(t_series, "UI", slices.series_uid).sequence(t_contour_image, std::move(images));
  Elements study;
  study.text(t_referenced_class, "UI", class_study_component)
      .text(t_referenced_uid, "UI", identity.study_uid)
      .item(t_rt_series, std::move(series));
  return e.item(t_rt_study, std::move(study));
}

}  // namespace

ObjectFile encode_structure_set(const CaseIdentity& identity, const SliceSet& slices,
                                const std::vector<ContouredSurface>& surfaces, const Progress& progress) {
  std::vector<Elements> rois, drawn, observations;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const ContouredSurface& s = surfaces[n];
    const std::string number = std::to_string(n + 1);
    std::vector<Elements> contours = contours_of(
        s, slices, progress.part(double(n) / double(surfaces.size()), double(n + 1) / double(surfaces.size())));
    if (contours.empty()) continue;
    rois.push_back(Elements()
                       .text(t_roi_number, "IS", number)
                       .text(t_roi_frame, "UI", identity.frame_uid)
                       .text(t_roi_name, "LO", s.name)
                       .text(t_roi_algorithm, "CS", "AUTOMATIC"));
    const auto part = [&](int k) { return int(std::lround(255 * s.colour_rgb[std::size_t(k)])); };
    drawn.push_back(Elements()
                        .text(t_roi_colour, "IS", fmt::format("{}\\{}\\{}", part(0), part(1), part(2)))
                        .text(t_referenced_roi, "IS", number)
                        .sequence(t_contours, std::move(contours)));
    const AnatomyCode& code = code_of(s.name);
    observations.push_back(Elements()
                               .text(t_observation_number, "IS", number)
                               .text(t_referenced_roi, "IS", number)
                               .code(t_roi_code, code.code, "SCT", code.meaning)
                               .text(t_roi_interpreted, "CS")
                               .text(t_roi_interpreter, "PN"));
  }
  if (rois.empty()) throw Error(ExitCode::bad_input, "", "dicom-rtss", "no anatomy meets any slice");
  Elements e = described(identity, "RTSTRUCT", 3, "Contours of the case");
  e.text(t_operators, "PN")
      .text(t_instance_number, "IS", "1")
      .text(t_set_label, "SH", "anatomies")
      .text(t_set_date, "DA")
      .text(t_set_time, "TM")
      .item(t_referenced_frame_of_reference, frame_of_reference(identity, slices))
      .sequence(t_rois, std::move(rois))
      .sequence(t_roi_contours, std::move(drawn))
      .sequence(t_observations, std::move(observations));
  // In explicit VR a contour of more than 64 KiB of text could not say its length.
  return encode_object(std::move(e), class_rtss, "", false);
}

}  // namespace trephine::pacs
