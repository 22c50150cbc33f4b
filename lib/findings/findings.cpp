// SPDX-License-Identifier: GPL-3.0-or-later
#include "findings/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "findings/findings_parts.h"
#include "head/head_figures.h"
#include "mask/filters.h"

namespace trephine::findings {
namespace {

constexpr double max_bone_noise_hu = 90;  ///< of a voxel: half of what bone is denser by than tissue
constexpr double of_parts = 0.42;         ///< most confidence of a shift that is measured in parts of the ventricles

/// The shift and the width of the ventricles, as a case's figures have them.
std::vector<Seen> of_figures(const FindingShapes& shapes, const FindingsParams& p, const Progress& progress) {
  std::vector<Seen> all;
  if (!shapes.ventricles) return all;
  const head::HeadFields fields{nullptr, shapes.skull, shapes.brain, shapes.ventricles, nullptr};
  const head::HeadFigures f = head::measure_head(fields, shapes.landmarks, {}, progress).result;
  // Horns of 15 mm have three slices of 5 mm, and where the septum lies is known no better.
  const Vec3 spacing = shapes.ventricles->spacing_mm;
  const double slices = mask::ramp(std::max({spacing.x, spacing.y, spacing.z}), 12, 3);
  const double plane = shapes.landmarks ? shapes.landmarks->midsagittal.confidence : 0.4;
  if (f.midline_shift_mm && std::abs(*f.midline_shift_mm) >= p.min_shift_mm) {
    Seen s;
    s.finding.kind = FindingKind::shift;
    s.finding.where = "of the " + f.midline_of;
    s.finding.position_mm = f.midline_place_mm;
    s.finding.confidence =
        0.9 * plane * slices * mask::ramp(std::abs(*f.midline_shift_mm), 0.5 * p.min_shift_mm, 1.7 * p.min_shift_mm);
    // Ventricles that cannot be whole: what is taken for the third one may be a piece of another. Two horns that face
    // each other across the septum are seen as they are.
    if (f.head_class == head::HeadClass::uncertain && f.midline_of != "septum")
      s.finding.confidence = std::min(s.finding.confidence, of_parts);
    s.finding.figures = {{"shift_mm", std::abs(*f.midline_shift_mm)}};
    s.finding.text = fmt::format("the midline is shifted by {:.1f} mm to the {} ({})", std::abs(*f.midline_shift_mm),
                                 *f.midline_shift_mm > 0 ? "left" : "right", f.midline_of);
    all.push_back(std::move(s));
  }
  if (f.evans_index_ratio && *f.evans_index_ratio > p.wide_evans_ratio) {
    Seen s;
    s.finding.kind = FindingKind::wide_ventricles;
    s.finding.where = "of the ventricles";
    s.finding.position_mm = f.evans_place_mm;
    s.finding.confidence = 0.9 * mask::ramp(*f.evans_index_ratio, p.wide_evans_ratio - 0.03, p.wide_evans_ratio + 0.04);
    s.finding.figures = {{"evans_index_ratio", *f.evans_index_ratio}, {"volume_ml", f.ventricles_ml.value_or(0)}};
    s.finding.text = fmt::format("the ventricles are wide (Evans' index {:.2f}, {})", *f.evans_index_ratio,
                                 ml_text(f.ventricles_ml.value_or(0)));
    all.push_back(std::move(s));
  }
  return all;
}

std::string side_of(Vec3 p, const head::HeadLandmarks* landmarks, Vec3 middle) {
  const bool known = landmarks && landmarks->midsagittal.confidence > 0;
  const double left = known ? dot(p - landmarks->midsagittal.point_mm, landmarks->midsagittal.normal) : p.x - middle.x;
  return left > 6 ? "left" : left < -6 ? "right" : "middle";
}

// "43 ml ... lie beside the brain, left (brain may be wrong because of it)"
std::string text_with_place(const Finding& f) {
  const std::string concerned = joined(f.concerns, " and ");
  return with_side(f.text, to_text(f.kind), f.side) +
         (concerned.empty() ? "" : " (" + concerned + " may be wrong because of it)");
}

// Many doubtful places are streaks or sinuses: one line for all of them, so that what is sure is not lost among them.
void warn_of_doubtful(const std::vector<Finding>& all, Warnings& warnings) {
  std::map<std::string, int> count;
  for (const Finding& f : all)
    if (f.confidence < sure_confidence) ++count[to_text(f.kind)];
  std::vector<std::string> kinds;
  for (const auto& [kind, n] : count) kinds.push_back(std::to_string(n) + " of " + kind);
  if (!kinds.empty())
    warnings.push_back({"doubtful_findings",
                        "doubtful, and perhaps something usual such as streaks or a sinus: {kinds}; the report says "
                        "where each is",
                        {{"kinds", joined(kinds)}}});
}

}  // namespace

const char* to_text(FindingKind kind) {
  switch (kind) {
    case FindingKind::dense:
      return "dense_tissue";
    case FindingKind::dark:
      return "dark_tissue";
    case FindingKind::shift:
      return "midline_shift";
    case FindingKind::wide_ventricles:
      return "wide_ventricles";
    case FindingKind::bone_gap:
      return "bone_gap";
    case FindingKind::metal:
      return "metal";
    case FindingKind::tube:
      break;
  }
  return "tube";
}

std::string with_side(const std::string& text, const std::string& kind, const std::string& side) {
  return kind == to_text(FindingKind::shift) || side == "middle" ? text : text + ", " + side;
}

bool is_seen_in_bone(const std::string& kind) {
  return kind == to_text(FindingKind::bone_gap) || kind == to_text(FindingKind::metal);
}

Findings find_findings(const grid::HuVolume& volume, const FindingShapes& shapes, const FindingsParams& params,
                       const Progress& progress) {
  const grid::Lattice& l = grid::lattice_of(volume);
  const auto check = [&](const grid::Field* f, const char* name, bool required) {
    if (required && !f) throw Error(ExitCode::usage, "", name, "is needed");
    if (f) with_field(name, [&] { grid::place_in(*f, l); });
  };
  check(shapes.skull, "skull", true);
  check(shapes.brain, "brain", true);
  check(shapes.ventricles, "ventricles", false);
  mask::check_finite(volume);
  const Inside in = inside_of(volume, shapes, progress.part(0, 0.5));
  Findings out;
  out.result.template_sure = in.place.sure;
  out.result.tissue_noise_hu = in.noise_hu;
  out.result.contrast_ml = in.contrast_ml;
  std::vector<Seen> implants = metal(in, volume, *shapes.skull, params, progress.part(0.5, 0.52));
  for (Seen& s : tubes(in, volume, shapes, params, progress.part(0.52, 0.55))) implants.push_back(std::move(s));
  std::vector<Seen> all = dense_tissue(in, implants, params, progress.part(0.55, 0.6));
  const auto append = [&](std::vector<Seen> more) {
    for (Seen& s : more) all.push_back(std::move(s));
  };
  append(dark_tissue(in, params, progress.part(0.6, 0.7)));
  append(air_inside(in));
  append(of_figures(shapes, params, progress.part(0.7, 0.8)));
  append(bone_gaps(in, volume, *shapes.skull, params));
  append(bone_dents(in, *shapes.skull, l));
  append(std::move(implants));

  // Noise that leaves no even tissue to measure it in: what is seen through it may be made of it. Bone stands out of
  // noise that hides all tissue.
  if (!in.noise_known) {
    const bool bone_is_seen = shapes.voxel_noise_hu > 0 && shapes.voxel_noise_hu < max_bone_noise_hu;
    out.warnings.push_back({"tissue_noise_unknown",
                            std::string("the noise of the brain's tissue cannot be measured: all but metal") +
                                (bone_is_seen ? " and gaps of the bone" : "") + " is doubtful",
                            {}});
    for (Seen& s : all)
      if (s.finding.kind != FindingKind::metal && !(bone_is_seen && s.finding.kind == FindingKind::bone_gap))
        s.finding.confidence = std::min(s.finding.confidence, 0.9 * sure_confidence);
  }
  if (in.contrast_ml > vessels_ml)
    out.warnings.push_back({"contrast_medium",
                            "{volume} inside the skull are as bright as vessels with contrast medium, whatever the "
                            "scan's tags say: tubes, and dense tissue beside it or of a few ml, are doubtful",
                            {{"volume", ml_text(in.contrast_ml)}, {"contrast_ml", in.contrast_ml}}});

  grid::Mask labels(in.cells());
  const Vec3 middle = in.envelope.centre_mm();
  std::vector<Finding>& list = out.result.list;
  for (Seen& s : all) {
    if (list.size() == 200) break;
    s.finding.side = side_of(s.finding.position_mm, shapes.landmarks, middle);
    list.push_back(s.finding);
    const int value = int(list.size());
    if (s.finding.confidence >= sure_confidence)
      out.warnings.push_back({to_text(s.finding.kind),
                              "to be looked at: {finding}",
                              {{"finding", text_with_place(s.finding)}, {"number", std::int64_t{value}}}});
    if (s.cells.lattice().count() == 0) continue;
    for (int k = 0; k < labels.size[2]; ++k)
      for (int j = 0; j < labels.size[1]; ++j)
        for (int i = 0; i < labels.size[0]; ++i)
          // What was found first, and is reported with these cells' volume, keeps them.
          if (s.cells.get(i, j, k) && labels.at(i, j, k) == 0) labels.at(i, j, k) = std::uint8_t(value);
    grid::LabelSegment segment;
    segment.id = "finding_" + std::to_string(value);
    segment.name = std::string(to_text(s.finding.kind)) + " " + std::to_string(value);
    segment.value = value;
    out.value.segments.push_back(segment);
  }
  warn_of_doubtful(list, out.warnings);
  out.result.findings_count = list.size();
  out.value.lattice = labels;
  out.value.samples = std::move(labels);
  out.value.format = "seg.nrrd";
  progress.report(1);
  return out;
}

}  // namespace trephine::findings
