// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/warning_kind.h"

#include <map>

namespace trephine::stages {
namespace {

using Kinds = std::map<std::string, WarningKind>;

void add(Kinds& kinds, Severity severity, const std::vector<std::string>& about, const std::vector<const char*>& ids) {
  for (const char* id : ids) kinds[id] = {severity, about, false};
}

Kinds make_kinds() {
  Kinds k;
  add(k, Severity::wrong, {},
      {"label_cut",
       "segment_cropped",
       "snake_leaked",
       "snake_at_edge",
       "snake_rests_on_limits",
       "snake_still_moves",
       "snake_does_nothing",
       "nothing_inside",
       "not_valid",
       "not_closed",
       "cavity_not_filled",
       "unusual_cranial_cavity",
       "unusual_ventricles",
       "unusual_canal",
       "unusual_content",
       "unusual_clavicle",
       "even_as_blood",
       "vein_estimated",
       "vein_in_bone_or_lung",
       "unusual_third_ventricle",
       "zone_in_air",
       "fat_inside_dura",
       "dura_not_seen"});
  add(k, Severity::wrong, {"ventricles"},
      {"many_pieces", "unequal_sides", "no_frontal_horn", "thin_frontal_horn", "short_ventricle", "no_part",
       "implausible_ventricles_volume", "implausible_evans_index", "implausible_shift", "noisy", "denoised_horns",
       "unsuited_scan"});
  add(k, Severity::wrong, {"ventricles", "third_ventricle"}, {"no_foramen", "no_third_ventricle"});
  add(k, Severity::wrong,
      {"skin", "skull", "brain", "ventricles", "dura", "midline", "sagittal_sinus", "third_ventricle", "brainstem"},
      {"unusual_proportions"});
  add(k, Severity::wrong, {}, {"blank_slices"});  // of all that the scan shows (import_stage.cpp)
  for (const char* id : {"unusual_proportions", "blank_slices"}) k[id].about_landmarks = true;
  add(k, Severity::wrong, {"skin", "bone", "canal"}, {"unusual_levels"});
  add(k, Severity::wrong, {"clavicle", "vein"}, {"no_clavicle"});
  add(k, Severity::wrong, {"lung", "pleura"}, {"lung_interrupted", "lung_ends_early"});
  add(k, Severity::note, {},
      {"isovalue_lowered",
       "axes_given",
       "offset_added",
       "hu_by_word",
       "volume_file",
       "label_file",
       "no_dice",
       "no_evans_index",
       "nasion_not_known",
       "given_transform_agrees",
       "landmark_not_found",
       "field_cuts",
       "changes_nothing",
       "attribute_changes",
       "resampled",
       "tilt_by_tag",
       "below_air",
       "beyond_metal",
       "negative_slope",
       "files_of_series",
       "projections",
       "odd_image",
       "links"});
  return k;
}

const Kinds& kinds() {
  static const Kinds all = make_kinds();
  return all;
}

}  // namespace

const char* to_text(Severity severity) {
  switch (severity) {
    case Severity::wrong:
      return "wrong";
    case Severity::look:
      return "look";
    case Severity::note:
      break;
  }
  return "note";
}

WarningKind kind_of(const Warning& warning) {
  const auto found = kinds().find(warning.id);
  return found == kinds().end() ? WarningKind{} : found->second;
}

std::vector<std::string> wrong_kinds() {
  std::vector<std::string> ids;
  for (const auto& [id, kind] : kinds())
    if (kind.severity == Severity::wrong) ids.push_back(id);
  return ids;
}

}  // namespace trephine::stages
