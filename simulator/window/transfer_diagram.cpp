// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/transfer_diagram.h"

#include <imgui.h>

#include <algorithm>

namespace trephine::window {
namespace {

constexpr double low_hu = voxel::transfer_low_hu, span_hu = voxel::transfer_high_hu - low_hu;
const ImU32 ground = IM_COL32(18, 20, 24, 255), bars = IM_COL32(70, 78, 90, 255), curve = IM_COL32(235, 238, 242, 255),
            threshold = IM_COL32(230, 159, 0, 160), touched = IM_COL32(230, 159, 0, 255);

ImU32 colour_of(const std::array<double, 3>& rgb) {
  return ImGui::ColorConvertFloat4ToU32({float(rgb[0]), float(rgb[1]), float(rgb[2]), 1});
}
float point_px() { return 0.4f * ImGui::GetFontSize(); }

}  // namespace

float TransferDiagram::x_of(double hu) const { return left_ + float((hu - low_hu) / span_hu) * width_; }
float TransferDiagram::y_of(double opacity) const { return top_ + float(1 - opacity) * height_; }
double TransferDiagram::hu_of(float x) const { return low_hu + double((x - left_) / width_) * span_hu; }
double TransferDiagram::opacity_of(float y) const { return 1 - double((y - top_) / height_); }

std::optional<std::size_t> TransferDiagram::under_mouse(const voxel::TransferFunction& f) const {
  const ImVec2 at = ImGui::GetIO().MousePos;
  std::optional<std::size_t> nearest;
  float least = 4 * point_px() * point_px();
  for (std::size_t n = 0; n < f.points.size(); ++n) {
    const float x = x_of(f.points[n].hu) - at.x, y = y_of(f.points[n].opacity) - at.y, squared = x * x + y * y;
    // Of two points at the same place the one that was selected remains in hand.
    if (squared < least || (squared == least && n == selected_)) {
      least = squared;
      nearest = n;
    }
  }
  return nearest;
}

std::optional<voxel::TransferFunction> TransferDiagram::use_mouse(const voxel::TransferFunction& f) {
  const ImVec2 at = ImGui::GetIO().MousePos;
  const bool over = ImGui::IsItemHovered();
  const auto under = over ? under_mouse(f) : std::nullopt;
  if (over && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && under) {
    dragged_ = selected_ = *under;
    grab_x_ = x_of(f.points[*under].hu) - at.x;
    grab_y_ = y_of(f.points[*under].opacity) - at.y;
  }
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) dragged_.reset();
  if (dragged_ && *dragged_ < f.points.size()) {
    if (!ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1)) return std::nullopt;  // a click only selects
    return cast::with_moved(f, *dragged_, hu_of(at.x + grab_x_), opacity_of(at.y + grab_y_));
  }
  if (over && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && !under) {
    if (auto added = cast::with_added(f, hu_of(at.x), opacity_of(at.y))) {
      selected_ = added->point;
      return std::move(added->function);
    }
  }
  if (under && ImGui::IsMouseClicked(ImGuiMouseButton_Right)) return cast::with_removed(f, *under);
  return std::nullopt;
}

std::optional<voxel::TransferFunction> TransferDiagram::draw(const voxel::TransferFunction& f,
                                                             const cast::HuHistogram& histogram, float width,
                                                             float height) {
  const ImVec2 from = ImGui::GetCursorScreenPos(), to{from.x + width, from.y + height};
  const float margin = point_px() + 1;
  left_ = from.x + margin;
  top_ = from.y + margin;
  width_ = std::max(1.f, width - 2 * margin);
  height_ = std::max(1.f, height - 2 * margin);
  ImGui::InvisibleButton("##transfer", {width, height},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  selected_ = std::min(selected_, f.points.size() - 1);
  std::optional<voxel::TransferFunction> made = use_mouse(f);
  const voxel::TransferFunction& shown = made ? *made : f;
  selected_ = std::min(selected_, shown.points.size() - 1);

  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.PushClipRect(from, to, true);
  list.AddRectFilled(from, to, ground);
  for (int bin = 0; bin < cast::HuHistogram::bins; ++bin) {
    const double hu = low_hu + double(bin * cast::HuHistogram::bin_hu);
    list.AddRectFilled({x_of(hu), y_of(histogram.height(bin))}, {x_of(hu + cast::HuHistogram::bin_hu), y_of(0)}, bars);
  }
  list.AddLine({from.x, y_of(shown.touched_from_opacity)}, {to.x, y_of(shown.touched_from_opacity)}, threshold);
  if (const auto range = voxel::touched_hu(shown))
    list.AddRectFilled({x_of((*range)[0]), y_of(0)}, {std::min(to.x, x_of((*range)[1])), to.y}, touched);
  const voxel::TransferPoint &first = shown.points.front(), &last = shown.points.back();
  list.AddLine({from.x, y_of(first.opacity)}, {x_of(first.hu), y_of(first.opacity)}, curve, 1.5f);
  for (std::size_t n = 1; n < shown.points.size(); ++n)
    list.AddLine({x_of(shown.points[n - 1].hu), y_of(shown.points[n - 1].opacity)},
                 {x_of(shown.points[n].hu), y_of(shown.points[n].opacity)}, curve, 1.5f);
  list.AddLine({x_of(last.hu), y_of(last.opacity)}, {to.x, y_of(last.opacity)}, curve, 1.5f);
  for (std::size_t n = 0; n < shown.points.size(); ++n) {
    const ImVec2 at{x_of(shown.points[n].hu), y_of(shown.points[n].opacity)};
    list.AddCircleFilled(at, point_px(), colour_of(shown.points[n].colour_rgb));
    list.AddCircle(at, point_px(), n == selected_ ? touched : curve, 0, n == selected_ ? 2.5f : 1.f);
  }
  list.PopClipRect();
  return made;
}

std::optional<voxel::TransferFunction> TransferDiagram::draw_point(const voxel::TransferFunction& f,
                                                                   const char* opacity_label,
                                                                   const char* colour_label) {
  std::optional<voxel::TransferFunction> made;
  selected_ = std::min(selected_, f.points.size() - 1);
  const voxel::TransferPoint& p = f.points[selected_];
  float hu = float(p.hu), opacity = float(p.opacity);
  float rgb[3] = {float(p.colour_rgb[0]), float(p.colour_rgb[1]), float(p.colour_rgb[2])};
  ImGui::PushItemWidth(ImGui::GetFontSize() * 6);
  if (ImGui::DragFloat("HU", &hu, 1, float(low_hu), float(voxel::transfer_high_hu), "%.0f",
                       ImGuiSliderFlags_AlwaysClamp))
    made = cast::with_moved(f, selected_, double(hu), p.opacity);
  ImGui::SameLine();
  if (ImGui::DragFloat(opacity_label, &opacity, 0.005f, 0, 1, "%.3f", ImGuiSliderFlags_AlwaysClamp))
    made = cast::with_moved(f, selected_, p.hu, double(opacity));
  ImGui::SameLine();
  if (ImGui::ColorEdit3(colour_label, rgb, ImGuiColorEditFlags_NoInputs))
    made = cast::with_colour(f, selected_, {double(rgb[0]), double(rgb[1]), double(rgb[2])});
  ImGui::PopItemWidth();
  return made;
}

}  // namespace trephine::window
