// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/hu_windows.h"

#include <algorithm>
#include <cmath>

namespace trephine::drill {

HuWindows::HuWindows(const voxel::HapticVolume& volume) : number_(65536, 0) {
  constexpr int vault_hu = 1000;  // above the threshold of bone
  lowest_ = volume.shapes.empty() ? 0 : volume.shapes.front().window_low;
  for (const voxel::HapticShape& s : volume.shapes) {
    lowest_ = std::min(lowest_, int(s.window_low));
    windows_[std::size_t(s.number)] = {s.window_low, std::clamp(s.window_high - s.window_low + 1, 1, vault_hu)};
    for (int hu = s.window_low; hu <= s.window_high; ++hu) number_[std::uint16_t(hu)] = std::uint8_t(s.number);
  }
}

std::int16_t HuWindows::target(int number, double stays) const {
  if (!(stays > 0)) return voxel::haptic_beyond_hu;
  const int low = windows_[std::size_t(number)].low;
  // Beside a voxel that holds nothing, the surface is then where the cutter's is.
  const int level = int(std::lround(low + (low - voxel::haptic_beyond_hu) * (2 * std::min(stays, 1.0) - 1)));
  return std::int16_t(std::clamp(level < low ? std::min(level, lowest_ - 1) : level, voxel::haptic_beyond_hu, 32767));
}

int HuWindows::left(int number, std::int16_t hu, std::int16_t target) const {
  return std::max(0, hu - std::max(int(target), windows_[std::size_t(number)].low - 1));
}

std::int16_t HuWindows::settled(int number, int hu, std::int16_t target) const {
  if (hu >= windows_[std::size_t(number)].low) return std::int16_t(std::max(hu, int(target)));
  return target < windows_[std::size_t(number)].low ? target : std::int16_t(windows_[std::size_t(number)].low);
}

}  // namespace trephine::drill
