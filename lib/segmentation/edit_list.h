// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine::segmentation {

/// A painted correction among other edits: a file of `trephine correction` beside the list.
struct PatchEdit {
  std::string file, sha256;
  template <class V>
  static void describe(V& v) {
    v.text(&PatchEdit::file, "file", "The file's name, in the folder of the list.").is_required();
    v.text(&PatchEdit::sha256, "sha256", "SHA-256 of its content, so that the list says all that is done.")
        .is_required();
  }
};

/// What a person did to one shape, one after the other, as a file (JSON):
/// {"trephine_edits": 1, "edits": [{"patch": {...}}, {"snake": {...}}, {"cut": {...}}, {"smooth": {...}}]}.
struct EditList {
  int version = 1;
  Steps edits;
  template <class V>
  static void describe(V& v) {
    v.integer(&EditList::version, "trephine_edits", Range{1, 1}, "Version of the format.").is_required();
    v.steps(&EditList::edits, "edits", choices(), "The edits, in the order in which they are done.").is_required();
  }
  static std::vector<StepChoice> choices();
};

/// The ball beyond which an edit that is no patch changes nothing but what the smoothing of its rim needs.
struct EditReach {
  Vec3 centre_mm;
  double radius_mm = 0;
};
EditReach reach_of(const std::string& name, const AnyParams& params);

/// Whether a file of that name is a list of edits, and not one painted correction.
bool is_edit_list(const std::filesystem::path& file);
/// Throws Error 66, and 65 naming the file and the place in it.
EditList read_edit_list(const std::filesystem::path& file);
std::string encode_edit_list(EditList list);

/// The field after all edits of the list, whose patches lie in `folder`. Report: added_ml and removed_ml of all
/// together, already_ratio (the largest of a patch), edits_count. Warns as corrected() and edited() do, saying of which
/// edit by its number from 1. Throws what they throw, naming the edit; Error 65 for a patch of another content.
grid::Field apply_edits(const grid::Field& field, const grid::HuVolume& volume, const EditList& list,
                        const std::filesystem::path& folder, Report& report, const Progress& progress = {});

}  // namespace trephine::segmentation
