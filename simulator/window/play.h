// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <string>

#include "base/params.h"
#include "fluoro/fluoroscope.h"
#include "render/mirror.h"
#include "window/player.h"
#include "window/texts.h"

namespace trephine::window {

/// The window itself.
struct WindowParams {
  int window_width = 1280, window_height = 720, screen_number = 0;
  double frames_per_s = 60, target_ms = 100, letters = 1;
  double fine_mm = 30;
  texts::Language language = texts::Language::english;
  bool panels = true;
  fluoro::MetalShown xray_metal = fluoro::MetalShown::bright;
  render::Mirror mirror = render::Mirror::none;
  template <class V>
  static void describe(V& v) {
    using P = WindowParams;
    v.integer(&P::window_width, "window_width", Range{200, 7680}, "Width of the window.");
    v.integer(&P::window_height, "window_height", Range{150, 4320}, "Height of the window.");
    v.integer(&P::screen_number, "screen_number", Range{0, 16},
              "Fill this screen, from 1 as the system counts them; 0: a window of that width and height.");
    v.number(&P::frames_per_s, "frames_per_s", Range{1, 500}, "Pictures a second, at most.");
    v.number(
        &P::target_ms, "target_ms", Range{0, 10000},
        "Time for a picture, by the clock and, where the processor draws, by what half of its cores can do in it; "
        "where pictures take longer, some of what makes them good is left out, and the window says what. 0: nothing "
        "is left out.");
    v.number(
        &P::fine_mm, "fine_mm", Range{0, 1000},
        "Where surfaces are drawn coarser because pictures take too long, they stay whole so far around the tool's "
        "tip.");
    v.number(&P::letters, "letters", Range{0.5, 5}, "Size of the letters; 1: 13 pixels.");
    v.choice(&P::language, "language", texts::languages(), "Language of the panels.");
    v.choice(&P::xray_metal, "xray_metal", {{"bright", fluoro::MetalShown::bright}, {"dark", fluoro::MetalShown::dark}},
             "How the C-arm's monitor shows bone and metal: bright, as on a film, or dark, as on most C-arms.");
    v.choice(&P::mirror, "mirror",
             {{"none", render::Mirror::none},
              {"left_right", render::Mirror::left_right},
              {"up_down", render::Mirror::up_down}},
             "Mirror the whole window, for a screen that is seen in a mirror over the hands.");
    v.flag(&P::panels, "panels", "Show the panels at the start; the key H shows and hides them.");
  }
};

struct PlayOutcome {
  double first_picture_s = 0, seconds = 0;
  double picture_ms = 0, picture_cpu_ms = 0;  ///< medians of the last 200; of CPU what all threads of the program took
  double longest_ms = 0;                      ///< of all but the first three pictures
  std::uint64_t pictures = 0;
  double graphics_mb = 0;    ///< at the end
  std::uint32_t faults = 0;  ///< of sessions (haptic_fault)
  std::string driver;
  std::string score;  ///< of a lesson, as a table; empty where none was judged
};

/// Opens a window and runs until the user ends it, `stop` is set, or the session ends. `begun`: when the program was
/// asked for it. `remote_port`: below 0, no remote. Throws Error 74 without a display or OpenGL 4.3, and where the
/// driver loses the context, after the session was finished and its recording written; else what Player throws.
PlayOutcome play(const PlayOptions& options, const WindowParams& window, int remote_port,
                 std::chrono::steady_clock::time_point begun, const std::atomic<bool>& stop,
                 const std::function<void(const std::string& line)>& say);

}  // namespace trephine::window
