// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"

namespace trephine::voxel {

/// The HU that a transfer function tells apart: 12 bits, as a scanner gives them. Below and above it goes on as it is
/// at these ends.
constexpr int transfer_low_hu = -1024, transfer_high_hu = 3071;

struct TransferPoint {
  double hu = 0, opacity = 0;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double stiffness_n_per_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = TransferPoint;
    v.number(&P::hu, "hu", Range{transfer_low_hu, transfer_high_hu}, "Where the point lies.").is_required();
    v.number(&P::opacity, "opacity", Range{0, 1},
             "Share of the light that a layer of 1 mm holds back: 0 is clear, 1 hides all behind it.")
        .is_required();
    v.numbers(&P::colour_rgb, "colour_rgb", Range{0, 1}, "Colour, sRGB.").is_required();
    v.number(&P::stiffness_n_per_mm, "stiffness_n_per_mm", Range{0, 10},
             "Stiffness of what is touched there, in place of the material's; of all points or of none.")
        .not_always();
  }
};

/// How HU are seen, and from where on they are felt [Rizzi, 3.5 and figure 9]: opacity, colour and, where it has them,
/// stiffness at points of HU, linear between them, and beyond the outermost points as these are. What is at least
/// `touched_from_opacity` opaque is touched, so a window of HU is the special case of a function that is 0 or 1.
struct TransferFunction {
  std::string preset;  ///< stands for points of its own; empty: `points` has them
  std::vector<TransferPoint> points;
  double touched_from_opacity = 0.5;
  template <class V>
  static void describe(V& v) {
    using P = TransferFunction;
    v.word(&P::preset, "preset", {"bone", "skin", "vessels"}, "Points that the program has, in place of `points`.")
        .not_always();
    v.list(&P::points, "points",
           "The points by ascending HU; opacity and colour are linear between them. Two points may lie at the same HU "
           "(a step), and the first has the opacity 0.")
        .at_most(64)
        .not_always();
    v.number(&P::touched_from_opacity, "touched_from_opacity", Range{0.01, 1},
             "What is at least so opaque is touched. That must be one range of HU.");
  }
  /// Says what is wrong where there are no points or two sorts of them, they do not ascend, the first is not clear,
  /// some but not all have a stiffness, or what is touched is not one range of HU.
  std::string fault() const;
};

/// The names of all presets.
std::vector<std::string> preset_names();
/// The points of a preset; there is one of that name.
const std::vector<TransferPoint>& preset_points(std::string_view name);
/// The same function, with the points of its preset in place of its name.
TransferFunction resolved(TransferFunction function);
/// 0 outside of the window, 1 in it (of whole HU, both ends included), of one colour.
TransferFunction window_function(int low_hu, int high_hu, std::array<double, 3> colour_rgb);

/// Of a resolved function.
TransferPoint at_hu(const TransferFunction& function, double hu);
/// The lowest and the highest whole HU that are touched; a range that goes on beyond the last point ends at 32767. None
/// where nothing is, or what is touched is not one range.
std::optional<std::array<int, 2>> touched_hu(const TransferFunction& function);

/// The largest stiffness that it gives to what it touches; 0 where its points have none.
double stiffest_n_per_mm(const TransferFunction& function);

/// Reads the text of a command line: the name of a preset, or points "HU:OPACITY:RRGGBB" with commas between them.
/// Throws Error 64 naming the flag and the limit.
TransferFunction transfer_from_text(const std::string& text, const std::string& flag);

}  // namespace trephine::voxel
