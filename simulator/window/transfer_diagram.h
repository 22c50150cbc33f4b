// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "cast/transfer_edit.h"

namespace trephine::window {

/// The diagram of a transfer function, in the panel that ImGui draws now: HU from left to right and opacity upwards,
/// over the histogram of the volume. The left button drags a point and selects it, a double click adds one, the right
/// button removes one. What is touched is marked along the lower edge.
class TransferDiagram {
 public:
  /// Returns the function as the user has changed it, where that was done.
  std::optional<voxel::TransferFunction> draw(const voxel::TransferFunction& f, const cast::HuHistogram& histogram,
                                              float width, float height);
  /// Fields of the selected point: HU, opacity and colour.
  std::optional<voxel::TransferFunction> draw_point(const voxel::TransferFunction& f, const char* opacity_label,
                                                    const char* colour_label);
  std::size_t selected() const { return selected_; }

 private:
  std::optional<voxel::TransferFunction> use_mouse(const voxel::TransferFunction& f);
  float x_of(double hu) const;
  float y_of(double opacity) const;
  double hu_of(float x) const;
  double opacity_of(float y) const;
  std::optional<std::size_t> under_mouse(const voxel::TransferFunction& f) const;

  float left_ = 0, top_ = 0, width_ = 1, height_ = 1;  // of what HU and opacity span, in pixels
  std::size_t selected_ = 0;
  std::optional<std::size_t> dragged_;
  float grab_x_ = 0, grab_y_ = 0;  // from the mouse to the middle of the point that is dragged
};

}  // namespace trephine::window
