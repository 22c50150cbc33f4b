// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/controls.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace trephine::window {
namespace {

using How = KeyUse::How;

constexpr double ask_again_s = 4;   // within which a key is pressed twice
constexpr double led_most_s = 0.1;  // of a held key's motion from picture to picture, however long one takes
constexpr double tap_s = 0.05, tap_wait_s = 0.2;  // a key that is tapped acts for so long; held, it goes on after that
constexpr double first_again_s = 0.5, next_again_s = 0.15;  // until a key that is held acts again

bool is_of(int key, const KeyUse& use) {
  return use.key == key || (use.how == How::numbered && key > use.key && key <= last_numbered(use.key));
}

// Calls `what` for each action that the key stands for, with how it does.
template <class F>
void each_use(int key, F what) {
  for (const Action& a : all_actions())
    for (const KeyUse& use : a.keys)
      if (is_of(key, use)) what(a, use);
}

// The action that has the key to itself now; null: none.
const Action* first_of(int key, const Player& player) {
  const Action* first = nullptr;
  each_use(key, [&](const Action& a, const KeyUse&) {
    if (a.first && !a.why_not(player)) first = &a;
  });
  return first;
}

}  // namespace

void Controls::apply(const std::vector<InputEvent>& events, Player& player, Screen& screen, bool panel_has_mouse,
                     bool panel_has_keys) {
  for (const InputEvent& e : events) {
    const bool key = e.kind == InputEvent::Kind::key;
    const bool is_panels = key ? panel_has_keys : panel_has_mouse;
    const int code = key ? e.code : mouse::left + e.code;
    switch (e.kind) {
      case InputEvent::Kind::key:
      case InputEvent::Kind::button:
        if (!e.down)
          release(code, player, screen);
        else if (!is_panels)
          press(code, player, screen);
        break;
      case InputEvent::Kind::move: {
        const double dx = cursor_known_ ? e.x - screen.cursor.x : 0, dy = cursor_known_ ? e.y - screen.cursor.y : 0;
        screen.cursor.x = e.x;
        screen.cursor.y = e.y;
        cursor_known_ = true;
        int part = mouse::move;
        for (const int button : {mouse::middle, mouse::right})
          if (down_.count(button)) part = button;
        drag(part, dx, dy, player, screen);
        break;
      }
      case InputEvent::Kind::wheel:
        if (!is_panels) drag(e.mods & GLFW_MOD_CONTROL ? mouse::control_wheel : mouse::wheel, 0, e.y, player, screen);
        break;
      case InputEvent::Kind::dropped:
        for (const int code_down : std::set<int>(down_)) release(code_down, player, screen);
        break;
    }
  }
}

void Controls::drag(int part, double x, double y, Player& player, const Screen& screen) {
  // While a button leads the tool by itself, the mouse's way does not.
  bool led = false;
  for (const int button : down_)
    each_use(button, [&](const Action& a, const KeyUse& use) {
      led = led || (part == mouse::move && button >= mouse::left && use.how == How::held && !a.why_not(player));
    });
  if (led) return;
  each_use(part, [&](const Action& a, const KeyUse& use) {
    if (use.how == How::drag && !a.why_not(player)) a.during(player, screen, {x, y, 0});
  });
}

void Controls::press(int key, Player& player, Screen& screen) {
  down_.insert(key);
  const auto is_down = [&](int left, int right) { return down_.count(left) || down_.count(right); };
  down_with_[key] = is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT)       ? KeyUse::With::shift
                    : is_down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL) ? KeyUse::With::control
                                                                             : KeyUse::With::nothing;
  if (key < mouse::left) screen.answer.reset();
  down_since_s_[key] = held_s_;
  const Action* first = first_of(key, player);
  each_use(key, [&](const Action& a, const KeyUse& use) {
    if (first && &a != first) return;
    std::string words = use.words;
    if (use.how == How::held && key < mouse::left && acts(use) && !a.why_not(player))
      a.during(player, screen, {use.x, use.y, tap_s});
    if (use.how == How::held || use.how == How::drag) return;
    if (use.how == How::numbered) {
      const std::vector<std::string> choices = a.choices(player);
      if (std::size_t(key - use.key) >= choices.size()) return;
      words = choices[std::size_t(key - use.key)];
    }
    if (use.how == How::twice && !a.why_not(player)) {
      const auto asked = asked_s_.find(&a);
      if (asked == asked_s_.end() || held_s_ - asked->second >= ask_again_s) {
        asked_s_[&a] = held_s_;
        screen.answer = texts::NoteId::enter_again;
        return;
      }
      asked_s_.erase(asked);  // a third press asks anew: the action may not have been done
    }
    again_s_ = held_s_ + first_again_s;
    screen.answer = act(a, player, screen, words).fault;
  });
}

bool Controls::acts(const KeyUse& use) { return use.with == KeyUse::With::any || use.with == down_with_[use.key]; }

void Controls::release(int key, Player& player, Screen& screen) {
  down_.erase(key);
  each_use(key, [&](const Action& a, const KeyUse& use) {
    if (!use.released.empty()) act(a, player, screen, use.released);
  });
}

void Controls::hold(double wall_s, Player& player, Screen& screen) {
  held_s_ += wall_s;
  for (const Action& a : all_actions()) {
    Gesture gesture{0, 0, std::min(wall_s, led_most_s)};
    bool held = false;
    for (const KeyUse& use : a.keys) {
      if (!down_.count(use.key)) continue;
      if (use.how == How::held && acts(use) &&
          (use.key >= mouse::left || held_s_ - down_since_s_[use.key] >= tap_wait_s)) {
        held = true;
        gesture.x += use.x;
        gesture.y += use.y;
      }
      const bool waits = player.lesson() && player.lesson()->commanding();
      if (use.how == How::again && held_s_ >= again_s_ && !waits && !a.why_not(player)) {
        act(a, player, screen, use.words);
        again_s_ = held_s_ + next_again_s;
      }
    }
    if (held && !a.why_not(player)) a.during(player, screen, gesture);
  }
}

}  // namespace trephine::window
