// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "head/head_figures.h"

namespace trephine::head {

/// The ventricles' own axes (unit vectors at right angles, the origin in the midsagittal plane), the middle between
/// their sides, and the level of the foramina of Monro along `back`.
struct VentricleAxes {
  Vec3 origin_mm, left, back;
  double middle_mm = 0;  ///< along `left`
  double monro_mm = 0;   ///< along `back`
};

struct VentricleDoubts {
  Warnings doubts;
  int pieces_count = 0;
  double sides_ratio = 1;
  double horn_mm2[2] = {0, 0};  ///< left, right
  bool horns_whole = true;
};

/// What speaks against the ventricles being whole, in the order of the limits in HeadClassParams.
/// - Pieces of at least 0.1 ml are counted.
/// - A frontal horn is what lies more than 4 mm in front of the foramina on its side. It is missing where it is shorter
///   than 6 mm, and a thread where the median of its cross-sections in coronal slabs of 2 mm is below
///   least_horn_mm2 or below least_horns_ratio of the other one's; `horns_whole` is then false, and no width across
///   both means anything.
/// - A side that reaches less than 0.6 times as far behind the foramina as the other one has lost its trigone.
/// - The foramina are judged where other landmarks were looked for: there is no way from a third ventricle into the
///   lateral ones where both are missing or doubtful.
/// - Volume, index and shift have to be those of a living person.
VentricleDoubts ventricle_doubts(const grid::Field& ventricles, const VentricleAxes& axes,
                                 const HeadLandmarks* landmarks, const HeadFigures& figures,
                                 const HeadClassParams& params);

/// Why ventricles of such a scan may be wrong whatever they look like: noise that hides horns, or a denoising that took
/// them away with it. Empty where neither is so, or the noise is not known.
std::optional<Warning> scan_doubt(const mask::ScanFigures& scan, const HeadClassParams& params);

/// Why a class would be a guess in a scan that is doubtful for ventricles by the usual limits (scan_verdict.h): a
/// figure lies so near to the border of its class that what is not seen may lie beyond it. Of an unsuited scan every
/// class is one. Empty where neither is so.
std::optional<Warning> close_call(const HeadFigures& figures, const mask::ScanFigures& scan,
                                  const HeadClassParams& params);

}  // namespace trephine::head
