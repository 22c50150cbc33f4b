// SPDX-License-Identifier: GPL-3.0-or-later
// What a folder holds beside the series that was chosen: a slice that vanishes is told of.
#include <cmath>

#include "dicom/catalogue.h"

namespace trephine::dicom {
namespace {

constexpr int max_told = 5;

/// What is said of a folder, warning by warning.
class Rest {
 public:
  void warn(const char* id, const char* form, Named<ParameterValue> values) {
    out.warnings.push_back({id, form, std::move(values)});
  }
  void add_broken(const Catalogue& c);
  void add_odd(const Catalogue& c, const Series& chosen);
  void add_patients(const Catalogue& c, const Series& chosen);

  FolderRest out;
};

void Rest::add_broken(const Catalogue& c) {
  int told = 0, more = 0, empty = 0, first_empty = 0;
  for (const auto& b : c.broken) {
    if (b.is_empty) {
      if (empty++ == 0) first_empty = b.number;
      continue;
    }
    if (!b.is_dicom) continue;
    if (++told > max_told) {
      ++more;
      continue;
    }
    warn("broken_file", "file {number} of {files} (by name) is DICOM and was left out: {why}",
         {{"number", b.number}, {"files", c.files}, {"why", b.field + (b.field.empty() ? "" : ": ") + b.what}});
  }
  if (more > 0) warn("more_broken_files", "{count} more DICOM files were left out", {{"count", more}});
  if (empty > 0)
    warn("empty_files", "{count} empty file{s}, the first is number {number} of {files} by name: a slice may be lost",
         {{"count", empty}, {"s", empty == 1 ? "" : "s"}, {"number", first_empty}, {"files", c.files}});
}

void Rest::add_odd(const Catalogue& c, const Series& chosen) {
  int told = 0;
  for (const OddSlice& odd : chosen.odd) {
    if (++told > max_told) continue;
    if (std::isnan(odd.along_mm))
      warn("odd_image", "an image with the series' UID and size was left out: {field}: {what}",
           {{"field", odd.field}, {"what", odd.what}});
    else
      warn("odd_slice",
           "a slice with the series' UID was left out, {along_mm:.1f} mm along the slices' normal, {where}: {field}: "
           "{what}",
           {{"along_mm", odd.along_mm},
            {"where", odd.within ? "between the others" : "beyond an end"},
            {"field", odd.field},
            {"what", odd.what}});
  }
  if (told > max_told)
    warn("more_odd_slices", "{count} more slices with the series' UID were left out", {{"count", told - max_told}});
  for (const Series& s : c.series)
    if (&s != &chosen && s.slices.empty() && s.sort_uid == chosen.sort_uid)
      warn("files_of_series", "{count} files with the series' UID were left out: {field}: {what}",
           {{"count", s.summary.size[2]}, {"field", s.refusal_field}, {"what", s.refusal.text()}});
}

/// By which attributes the series says who the patient is, and other patients' series in the same folder: the choice
/// may have been another one than was meant.
void Rest::add_patients(const Catalogue& c, const Series& chosen) {
  const Identity own = identity_of(chosen.slices).identity;
  std::string there;
  for (int which = 0; which < identity_count; ++which)
    if (own.said[static_cast<std::size_t>(which)] != 0)
      there += (there.empty() ? "" : ", ") + std::string(identity_keyword(which));
  out.result.patient_said_by = there.empty() ? "nothing" : there;
  const int others = of_other_patients(c, chosen);
  if (others > 0)
    warn("other_patients", "{count} other series of the folder {are} of another patient",
         {{"count", others}, {"are", others == 1 ? "is" : "are"}});
}

}  // namespace

int of_other_patients(const Catalogue& c, const Series& chosen) {
  const Identity own = identity_of(chosen.slices).identity;
  int others = 0;
  for (const Series& s : c.series) {
    if (&s == &chosen || s.slices.empty()) continue;
    const Identity other = identity_of(s.slices).identity;
    bool apart = false;
    for (int which = 0; which < identity_count; ++which) apart = apart || own.contradicts(other, which);
    others += apart;
  }
  return others;
}

FolderRest describe_rest(const Catalogue& c, const Series* chosen) {
  Rest r;
  int others = 0, other_files = 0;
  for (const Series& s : c.series) {
    if (&s == chosen) continue;
    ++others;
    other_files += s.summary.size[2];
  }
  FolderFigures& f = r.out.result;
  for (const auto& b : c.broken) (b.is_dicom ? f.skipped_broken_count : f.skipped_not_dicom_count) += 1;
  f.files_count = c.files;
  if (chosen) {
    f.other_series_count = others;
    f.other_series_slices_count = other_files;
  }
  f.localizers_count = c.localizers;
  f.images_without_geometry_count = c.without_geometry;
  f.skipped_hidden_count = c.hidden;
  if (c.links > 0) {
    f.skipped_links_count = c.links;
    r.warn("links",
           "{count} symbolic link{were} not read: what is read must lie in the folder or archive that was named",
           {{"count", c.links}, {"were", c.links == 1 ? " was" : "s were"}});
  }
  r.add_broken(c);
  if (chosen) r.add_odd(c, *chosen);
  if (chosen) r.add_patients(c, *chosen);
  for (const Series& s : c.series)
    if (chosen && s.part_of == chosen->summary.token)
      r.warn("part_scanned_again",
             "{count} slices scan a part of the series again, of other acquisitions at positions between its own, and "
             "were left out; the list has them as {token}",
             {{"count", static_cast<std::int64_t>(s.slices.size())},
              {"token", s.summary.token.substr(0, s.summary.token.find('-'))}});
  for (const Series& s : c.series)
    if (chosen && &s != chosen && (s.is_ct || s.sort_uid.empty()) && !s.refusal.empty())
      r.warn("series_not_used", "not used: {series}: {verdict}",
             {{"series", s.summary.line()}, {"verdict", s.summary.verdict}});
  return std::move(r.out);
}

}  // namespace trephine::dicom
