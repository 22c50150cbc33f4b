// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/result.h"
#include "dicom/import.h"
#include "grid/grid.h"
#include "look/blank_slices.h"

namespace trephine::look {

/// How a head lies in a scan by what the picture shows, against what the scan's directions say.
enum class Seen {
  unknown,   ///< no cranial cavity, or too little of face and neck to tell
  as_said,   ///< the face lies in front of the brain and below it, as the directions say
  otherwise  ///< it does not
};

/// What a scan shows before anything is made of it.
struct ScanLook {
  Seen head = Seen::unknown;
  /// In voxel axes, to which side of the patient each runs by the picture, where `head` is otherwise: as the slices are
  /// stored in the wrong order, and as the patient lay otherwise. Letters are L, R, P, A, S, I.
  std::string axes_if_mirrored, axes_if_turned;
  std::string what_is_seen;       ///< "upside down: face and neck lie above the brain"; empty where nothing is wrong
  std::vector<std::string> ends;  ///< "below 9,200 mm2": where the scan's sides cut the body
  std::optional<BlankSlices> blank;
  std::vector<std::string> sayings;  ///< whole sentences that a person should read; each is a warning
};

/// Looks at cells of about 3 mm, in about a second of CPU time. `patient_position` is DICOM's ("HFS"), or empty.
///
/// - *Orientation.* The cranial cavity is found (head/cranium.h). The plane in which the skull about it is most alike
///   at both sides is the midsagittal one. Bone of the face and air within the head (sinuses, nose, throat) lie in
///   front of the brain and below it. Where they clearly do not, the picture contradicts the directions. A head that is
///   mirrored from left to right cannot be told: nothing in it says which side is which.
/// - *Table.* A table or board is what stays alike along the patient over the whole scan. It lies below: where the
///   patient's position says another side, that is told.
/// - *Blank slices.* look/blank_slices.h.
/// - *Ends.* Where the body, without such a table, reaches the volume's sides, and how far the round field of view or
///   padding is its edge.
///
/// The result is the same whatever the thread count. Throws Error 65 where a voxel is not finite; Cancelled.
ScanLook look_at(const grid::HuVolume& volume, const std::string& patient_position, const Progress& progress = {});

/// The same of a scan that was read; nothing where it is no CT.
std::optional<ScanLook> look_at_ct(const grid::HuVolume& volume, const dicom::ImportFigures& scan,
                                   const Progress& progress = {});

/// What is printed of it.
struct LookFigures {
  Seen head = Seen::unknown;
  std::string scan_cuts_body;
  std::optional<std::int64_t> blank_slices_count;  ///< where there are some
  template <class V>
  static void describe(V& v) {
    v.choice(&LookFigures::head, "head_orientation",
             {{"unknown", Seen::unknown}, {"as said", Seen::as_said}, {"otherwise", Seen::otherwise}},
             "Whether the head lies as the scan says.");
    v.text(&LookFigures::scan_cuts_body, "scan_cuts_body", "Where the scan's sides cut the body.");
    v.integer(&LookFigures::blank_slices_count, "blank_slices_count",
              "Slices that are copies of the one before, or of a single value.");
  }
};
LookFigures figures_of(const ScanLook& look);
/// One for each saying, one of blank slices, and where the head lies otherwise than the scan says.
Warnings warnings_of(const ScanLook& look);

/// Throws Error 65, field `orientation_reason`, where the head lies otherwise than said and no reason is given.
void require_orientation(const ScanLook& look, const std::string& reason);

}  // namespace trephine::look
