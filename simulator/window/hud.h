// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <memory>
#include <string>

#include "window/actions.h"
#include "window/glfw_window.h"
#include "window/layout.h"
#include "window/texts.h"
#include "window/transfer_diagram.h"

namespace trephine::window {

/// Times of the pictures, for the panel.
struct PictureTimes {
  double ms = 0, per_s = 0;
  std::string reduced;  ///< what is left out to reach the target, or an empty text
};

/// The window's panels: anatomies, views, cut, tools, what is measured, and the recording that is shown.
class Hud {
 public:
  /// `scale`: size of the letters, 1 for 13 pixels.
  Hud(GlfwWindow& window, double scale, texts::Language language);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  /// Whether mouse and keys are for a panel.
  bool has_mouse() const;
  bool has_keys() const;
  void draw(Player& player, Screen& screen, const PictureTimes& times);

 private:
  void patient_panel(Player& player, Screen& screen);
  void keys_list(const Player& player);
  void status_panel(const Player& player, const Screen& screen, const PictureTimes& times);
  void show_times(const Player& player, const PictureTimes& times);
  void note_list(const Notes& notes, bool log, int height);
  void lesson_panel(Player& player, Screen& screen);
  void score_panel(const LessonController& lesson);
  void xray_panel(Player& player, Screen& screen);
  void shot_panel(Player& player);  // of a review
  void xray_picture(const XrayPictures& pictures, float edge);
  void inset_letters(const Player& player, int width, int height);
  void playback_panel(ShownRecording& shown);
  void transfer_panel(Player& player, Screen& screen);
  const char* say(Text text) const { return text_of(language_, text); }
  Layout layout_{1, 1, 1, false, false, false, false};  // of the picture that is drawn
  double scale_;
  texts::Language language_;
  std::deque<std::string> note_lines_;  // of the notes that are kept, as they are shown
  std::size_t notes_seen_ = 0;
  fluoro::MetalShown metal_ = fluoro::MetalShown::bright;
  TransferDiagram diagram_;
  cast::HuHistogram histogram_;
  std::pair<const grid::Grid<std::int16_t>*, int> counted_{nullptr, 0};  // the volume of the histogram, and its stage
  unsigned texture_ = 0;                                 // of the fluoroscopic picture; 0 before the first
  std::pair<std::uint64_t, bool> in_texture_{0, false};  // XrayPictures::made and flipped of what it holds
};

}  // namespace trephine::window
