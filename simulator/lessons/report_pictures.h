// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/html_text.h"
#include "cases/load_case.h"
#include "texts/language.h"

namespace trephine::lessons::detail {

/// A way, a ring or a dot in a picture.
struct PictureMark {
  std::vector<Vec3> points_mm;  ///< one: a ring around it
  std::string kind;             ///< class of the style: way, expert, target, hole, tip
};

/// What is shown black and what white; by default a brain.
struct PictureWindow {
  double low_hu = -20, high_hu = 120;
};
/// Three slices of the CT through the point, 160 mm wide, with the marks projected onto them, the patient's sides at
/// the edges (R, L, A, P, S, I) and a bar of 50 mm, as HTML.
std::string slices_html(const cases::LoadedCase& loaded, Vec3 through_mm, const std::vector<PictureMark>& marks,
                        texts::Language language, const PictureWindow& window = {});

/// Text without what HTML takes for its own.
inline std::string escaped(const std::string& text) { return html_text(text); }

}  // namespace trephine::lessons::detail
