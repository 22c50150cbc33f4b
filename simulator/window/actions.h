// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "fluoro/fluoroscope.h"
#include "render/mirror.h"
#include "window/player.h"

namespace trephine::window {

/// The window's own state, as actions find and change it.
struct Screen {
  Cursor cursor;
  bool panels_shown = true, editor_shown = false;  ///< the editor: of the transfer function
  fluoro::MetalShown metal = fluoro::MetalShown::bright;
  render::Mirror mirror = render::Mirror::none;  ///< of the whole window
  texts::Language language = texts::Language::english;
  ScreenHandParams hand;
  texts::Answer answer;  ///< to the last key or button
};

/// What follows an action's name in a line of the remote, or stands with a key. Throws Error 64 where it is not what is
/// asked for.
class Words {
 public:
  explicit Words(const std::string& line);
  Words(std::string verb, const std::string& text);
  const std::string& verb() const { return verb_; }
  bool more() const { return next_ < words_.size(); }
  std::string word();  ///< empty where there is none left
  double number();
  Vec3 point();
  bool on(bool now);  ///< on, off, or toggle

 private:
  std::string verb_;
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

/// What an action says: nothing, why it cannot be done, or what was asked for.
struct Reply {
  texts::Answer fault;
  std::string told;
  Reply() = default;
  Reply(texts::NoteId id) : fault(id) {}
  Reply(texts::Answer answer) : fault(std::move(answer)) {}
  Reply(std::string what) : told(std::move(what)) {}
};

/// Codes of the mouse, beside GLFW's keys.
namespace mouse {
constexpr int left = 1000, right = 1001, middle = 1002, move = 1010, wheel = 1011, control_wheel = 1012;
}

/// A key or a part of the mouse, and how it acts.
struct KeyUse {
  enum class How {
    press,     ///< once
    again,     ///< and on and on while it is down
    twice,     ///< at the second time within four seconds
    numbered,  ///< this key and those after it stand for the action's choices
    held,      ///< as long as it is down: Action::during
    drag       ///< with the mouse's way, or the wheel's: Action::during
  };
  int key = 0;
  How how = How::press;
  std::string words = "";     ///< the action's, when it is pressed
  std::string released = "";  ///< and when it is released; empty: nothing
  double x = 0, y = 0;        ///< of a key that is held: which way
  enum class With { any, nothing, shift, control };
  With with = With::any;  ///< of a key that is held: what is held with it
};

/// How far a key that is held, the mouse or its wheel has gone.
struct Gesture {
  double x = 0, y = 0;  ///< of the keys that are down, the mouse's way in pixels, or the wheel's steps (y)
  double seconds = 0;   ///< since the last picture; 0: of the mouse
};

/// What a user can do, declared once, in actions.cpp. Keys, buttons, the remote's lines, the help of the panels and the
/// tables of docs/reference/window.md come from there.
struct Action {
  enum class Group { work, lesson, arm };
  std::string name, arguments;  ///< of the remote's line; an action without a name has none
  Group group = Group::work;
  texts::Wording label, what;  ///< of its button; what it does. One for programs alone is said in English alone
  std::vector<KeyUse> keys;
  bool first = false;                                              ///< while it can be done, its keys do nothing else
  texts::Answer (*enabled)(const Player&) = nullptr;               ///< why it cannot be done now; null: it always can
  std::function<std::vector<std::string>(const Player&)> choices;  ///< a button for each, and its words
  std::function<Reply(Player&, Screen&, Words&)> run;
  void (*during)(Player&, const Screen&, const Gesture&) = nullptr;

  texts::Answer why_not(const Player& player) const { return enabled ? enabled(player) : texts::Answer(); }
};
const std::vector<Action>& all_actions();
const Action& action_of(const std::string& name);  ///< there must be one

/// Does it, where it is enabled.
Reply act(const Action& action, Player& player, Screen& screen, const std::string& words);
/// A line of the remote: "ok", "error: ...", or what was asked for.
std::string answer_line(const std::string& line, Player& player, Screen& screen);

/// The last key of those that stand for choices, from this one.
int last_numbered(int first);
/// "W", "left button", "Pos1".
std::string key_name(int key, texts::Language language);
/// All keys of an action: "F, L, O", "1 to 9", "Enter, twice".
std::string keys_text(const Action& action, texts::Language language);
/// What keys do that do something now, a line each.
std::string keys_help(const Player& player, texts::Language language);
/// The tables of docs/reference/window.md: by key, of a group; and the remote's lines.
std::string keys_table(Action::Group group);
std::string remote_table();

// What the remote is told.
std::string state_text(const Player& player);
std::string lesson_text(const Player& player);
std::string xray_text(const Player& player);

}  // namespace trephine::window
