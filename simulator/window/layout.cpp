// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/layout.h"

#include <algorithm>

namespace trephine::window {
namespace {

constexpr float margin = 8;

}  // namespace

Layout::Layout(float width, float height, float letter, bool has_xray, bool has_scores, bool has_shots, bool has_time) {
  const float half = 0.5f * width - 1.5f * margin;
  float bottom = height - margin;
  if (has_time) {
    const float high = 4.5f * letter;
    time = {0.15f * width, bottom - high, 0.7f * width, high};
    bottom -= high + margin;
  }
  const float room = bottom - margin;
  work = {margin, margin, std::min(22 * letter, half), room};
  const float right = std::min(27 * letter, half);
  status = {width - margin - right, margin, right, room};
  // The lower part of a column; the panel above it keeps the rest.
  const auto below = [&](Place& above, float wide, float high, bool on_right, float most = 0.7f) {
    const float w = std::min(std::max(wide, 14 * letter), half), h = std::min(high, most * room);
    above.height = room - h - margin;
    return Place{on_right ? width - margin - w : margin, bottom - h, w, h};
  };
  const float side = std::clamp(0.5f * std::min(width, height), 120.f, 512.f);
  // X-rays are what such a lesson is done by: as large as the patient beside them allows, who keeps a little more of
  // what the work leaves (at 1024 pixels a third of the window is left for the picture). The status keeps some lines.
  const float beside_work = 0.497f * (width - work.width - 2 * margin);
  const float monitor = std::clamp(std::min(0.68f * height, beside_work), 120.f, 900.f), few_lines = 6 * letter;
  if (has_xray) {
    status.width = std::min(right, std::max(monitor, 14 * letter));
    status.x = width - margin - status.width;
    xray = below(status, monitor, monitor + 6.3f * letter, true, std::min(0.82f, 1 - few_lines / room));
  }
  if (has_scores) scores = below(status, 30 * letter, 0.55f * room, true);
  const float column = std::max(has_xray ? xray.width : 0.f, status.width);
  patient = {work.x + work.width, 0, width - margin - column - work.x - work.width, height};
  const float wide = std::min(std::clamp(patient.width - 2 * margin, 30 * letter, 60 * letter), width - 2 * margin);
  const float high = std::min(22 * letter, 0.6f * room);
  const float beside = std::min(patient.x + 0.5f * (patient.width - wide), width - margin - wide);
  transfer = {std::max(margin, beside), bottom - high, wide, high};
  if (has_shots) shots = below(work, 0.9f * side, 0.9f * side + 6 * letter, false);
}

}  // namespace trephine::window
