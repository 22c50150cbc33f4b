// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/params.h"
#include "device/screen_registration.h"

namespace trephine::session {

/// How a device is registered to a screen: marks are touched one after the other, each with the first button down.
struct RegisterParams {
  double screen_width_mm = 0, screen_height_mm = 0, largest_residual_mm = 3, touch_s = 0.3, touch_wait_s = 120,
         register_hz = 1000;
  bool fit_scale = false, in_real_time = true;
  template <class V>
  static void describe(V& v) {
    using P = RegisterParams;
    v.number(&P::screen_width_mm, "screen_width_mm", Range{50, 5000}, "Width of the picture on the screen, measured.");
    v.number(&P::screen_height_mm, "screen_height_mm", Range{50, 5000}, "And its height.");
    v.number(&P::largest_residual_mm, "largest_residual_mm", Range{0.01, 100},
             "Refuse a registration of which a mark lies farther from where it was touched.");
    v.flag(&P::fit_scale, "fit_scale", "Also find how many mm before the screen a mm of the device is; else 1.");
    v.number(&P::touch_s, "touch_s", Range{0.02, 10}, "For how long the button is held at each mark.");
    v.number(&P::touch_wait_s, "touch_wait_s", Range{0.1, 3600}, "For how long each touch is waited for.");
    v.number(&P::register_hz, "register_hz", Range{50, 20000}, "Ticks in each second.");
    v.flag(&P::in_real_time, "in_real_time", "Keep to the clock; without it, as fast as the device gives poses.");
  }
};

/// Where the marks are, mm from the middle of the screen as it is seen: upper left, upper right, lower right, lower
/// left, middle.
std::vector<Vec3> screen_marks(const RegisterParams& params);
/// A page that fills a screen and shows the marks with their numbers; `flip` is a CSS transform, such as scaleY(-1).
std::string marks_sheet(const RegisterParams& params, const std::string& flip);

/// Has the marks touched in their order, and then a place in the air before the screen, which tells the side that the
/// user is on; a plane of marks alone would fit its mirror image as well. `say` gets what to touch next. Throws Error
/// 74 where the device is lost; 80 where nobody touches, a touch was held too restlessly three times, the marks are not
/// met within largest_residual_mm (naming the worst), or the last place lies behind the screen; as fit_screen does;
/// Cancelled.
device::ScreenRegistration register_screen(device::Device& device, const RegisterParams& params,
                                           const std::atomic<bool>& stop,
                                           const std::function<void(const std::string&)>& say);

}  // namespace trephine::session
