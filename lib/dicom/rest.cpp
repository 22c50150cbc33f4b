// SPDX-License-Identifier: GPL-3.0-or-later
// What a folder holds beside the series that was chosen: a slice that vanishes is told of.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dicom/catalogue.h"

namespace trephine::dicom {
namespace {

constexpr int max_told = 5;

void warn_of_broken(const Catalogue& c, Report& r) {
  int told = 0, more = 0, empty = 0;
  for (const auto& b : c.broken) {
    if (b.what.rfind("an empty file", 0) == 0) {
      ++empty;
      continue;
    }
    if (!b.is_dicom) continue;
    if (++told > max_told) {
      ++more;
      continue;
    }
    r.warn(fmt::format("file {} of {} (by name) is DICOM and was left out: {}{}{}", b.number, c.files, b.field,
                       b.field.empty() ? "" : ": ", b.what));
  }
  if (more > 0) r.warn(fmt::format("{} more DICOM files were left out", more));
  if (empty > 0) {
    const auto first = std::find_if(c.broken.begin(), c.broken.end(),
                                    [](const auto& b) { return b.what.rfind("an empty file", 0) == 0; });
    r.warn(fmt::format("{} empty file{}, the first is number {} of {} by name: a slice may be lost", empty,
                       empty == 1 ? "" : "s", first->number, c.files));
  }
}

void warn_of_odd(const Catalogue& c, const Series& chosen, Report& r) {
  int told = 0;
  for (const OddSlice& odd : chosen.odd)
    if (++told <= max_told)
      r.warn(
          std::isnan(odd.along_mm)
              ? fmt::format("an image with the series' UID and size was left out: {}: {}", odd.field, odd.what)
              : fmt::format("a slice with the series' UID was left out, {:.1f} mm along the slices' normal, {}: {}: {}",
                            odd.along_mm, odd.within ? "between the others" : "beyond an end", odd.field, odd.what));
  if (told > max_told) r.warn(fmt::format("{} more slices with the series' UID were left out", told - max_told));
  for (const Series& s : c.series)
    if (&s != &chosen && s.slices.empty() && s.sort_uid == chosen.sort_uid)
      r.warn(fmt::format("{} files with the series' UID were left out: {}: {}", s.summary.size[2], s.refusal_field,
                         s.refusal));
}

/// By which attributes the series says who the patient is, and other patients' series in the same folder: the choice
/// may have been another one than was meant.
void describe_patients(const Catalogue& c, const Series& chosen, Report& r) {
  const Identity own = identity_of(chosen.slices).identity;
  std::string there;
  for (int which = 0; which < identity_count; ++which)
    if (own.said[static_cast<std::size_t>(which)] != 0)
      there += (there.empty() ? "" : ", ") + std::string(identity_keyword(which));
  r.add("patient_said_by", there.empty() ? "nothing" : there);
  int others = 0;
  for (const Series& s : c.series) {
    if (&s == &chosen || s.slices.empty()) continue;
    const Identity other = identity_of(s.slices).identity;
    bool apart = false;
    for (int which = 0; which < identity_count; ++which) apart = apart || own.contradicts(other, which);
    others += apart;
  }
  if (others > 0)
    r.warn(fmt::format("{} other series of the folder {} of another patient", others, others == 1 ? "is" : "are"));
}

}  // namespace

Report describe_rest(const Catalogue& c, const Series* chosen) {
  Report r;
  int others = 0, refused = 0, other_files = 0;
  for (const Series& s : c.series) {
    if (&s == chosen) continue;
    ++others;
    refused += !s.refusal.empty() && s.is_ct;
    other_files += s.summary.size[2];
  }
  int not_dicom = 0, cut_short = 0;
  for (const auto& b : c.broken) (b.is_dicom ? cut_short : not_dicom) += 1;
  r.add("files_count", c.files);
  if (chosen) {
    r.add("other_series_count", others);
    r.add("other_series_slices_count", other_files);
  }
  r.add("localizers_count", c.localizers);
  r.add("images_without_geometry_count", c.without_geometry);
  r.add("skipped_not_dicom_count", not_dicom);
  r.add("skipped_broken_count", cut_short);
  r.add("skipped_hidden_count", c.hidden);
  if (c.links > 0) {
    r.add("skipped_links_count", c.links);
    r.warn(fmt::format("{} symbolic link{} not read: what is read must lie in the folder or archive that was named",
                       c.links, c.links == 1 ? " was" : "s were"));
  }
  warn_of_broken(c, r);
  if (chosen) warn_of_odd(c, *chosen, r);
  if (chosen) describe_patients(c, *chosen, r);
  for (const Series& s : c.series)
    if (chosen && s.part_of == chosen->summary.token)
      r.warn(
          fmt::format("{} slices scan a part of the series again, of other acquisitions at positions between its own, "
                      "and were left out; the list has them as {}",
                      s.slices.size(), s.summary.token.substr(0, s.summary.token.find('-'))));
  for (const Series& s : c.series)
    if (chosen && &s != chosen && (s.is_ct || s.sort_uid.empty()) && !s.refusal.empty())
      r.warn("not used: " + s.summary.line() + ": " + s.summary.verdict);
  return r;
}

}  // namespace trephine::dicom

namespace trephine::dicom {

std::string SeriesSummary::line() const {
  std::string out =
      fmt::format("{}: {}, {:.4g} x {:.4g} x {:.4g} mm", token, modality, spacing_mm.x, spacing_mm.y, spacing_mm.z);
  if (!kernel.empty()) out += ", kernel " + kernel;
  if (slice_thickness_mm > 0) out += fmt::format(", slice thickness {:.4g} mm", slice_thickness_mm);
  if (!image_type.empty()) out += ", " + image_type;
  out += contrast == "yes" ? ", contrast" : contrast == "no" ? ", no contrast" : ", contrast not told";
  return out;
}

const char* SeriesSummary::contrast_text() const { return contrast.empty() ? "not told" : contrast.c_str(); }

}  // namespace trephine::dicom
