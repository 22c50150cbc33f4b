// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
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

struct EditsResult {
  double added_ml = 0, removed_ml = 0;  ///< of all together
  double already_ratio = 0;             ///< the largest of a patch
  std::size_t edits_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = EditsResult;
    v.number(&P::added_ml, "added_ml", Range{}, "Volume that was added.");
    v.number(&P::removed_ml, "removed_ml", Range{}, "Volume that was removed.");
    v.number(&P::already_ratio, "already_ratio", Range{}, "Largest share of a patch that held without it.");
    v.integer(&P::edits_count, "edits_count", Range{}, "Edits.");
  }
};

/// The field after all edits of the list, whose patches lie in `folder`. Warns as corrected() and edited() do, saying
/// of which edit by its number from 1. Throws what they throw, naming the edit; Error 65 for a patch of another
/// content.
Outcome<grid::Field, EditsResult> apply_edits(const grid::Field& field, const grid::HuVolume& volume,
                                              const EditList& list, const std::filesystem::path& folder,
                                              const Progress& progress = {});

}  // namespace trephine::segmentation
