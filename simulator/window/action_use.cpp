// SPDX-License-Identifier: GPL-3.0-or-later
// How actions are done by a line, and how they are listed.
#include <cmath>
#include <sstream>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "base/error.h"
#include "window/actions.h"

namespace trephine::window {
namespace {

struct KeyWord {
  int key;
  texts::Wording name;
};
constexpr KeyWord key_words[] = {
    {mouse::left, {{"left button", "linke Taste"}}},
    {mouse::right, {{"right button", "rechte Taste"}}},
    {mouse::middle, {{"middle button", "mittlere Taste"}}},
    {mouse::move, {{"mouse", "Maus"}}},
    {mouse::wheel, {{"wheel", "Rad"}}},
    {mouse::control_wheel, {{"Ctrl + wheel", "Strg + Rad"}}},
    {GLFW_KEY_SPACE, {{"space", "Leertaste"}}},
    {GLFW_KEY_ENTER, {{"Enter", "Eingabe"}}},
    {GLFW_KEY_BACKSPACE, {{"Backspace", "Rücktaste"}}},
    {GLFW_KEY_ESCAPE, {{"Esc", "Esc"}}},
    {GLFW_KEY_HOME, {{"Home", "Pos1"}}},
    {GLFW_KEY_COMMA, {{"comma", "Komma"}}},
    {GLFW_KEY_PERIOD, {{"period", "Punkt"}}},
    {GLFW_KEY_PAGE_UP, {{"page up", "Bild auf"}}},
    {GLFW_KEY_PAGE_DOWN, {{"page down", "Bild ab"}}},
    {GLFW_KEY_LEFT, {{"left", "links"}}},
    {GLFW_KEY_RIGHT, {{"right", "rechts"}}},
    {GLFW_KEY_UP, {{"up", "auf"}}},
    {GLFW_KEY_DOWN, {{"down", "ab"}}},
    {GLFW_KEY_EQUAL, {{"+", "+"}}},
    // The same as another key of the action, on the keypad.
    {GLFW_KEY_KP_ADD, {{"", ""}}},
    {GLFW_KEY_KP_SUBTRACT, {{"", ""}}},
    {GLFW_KEY_KP_ENTER, {{"", ""}}},
};
constexpr texts::Wording with_words[] = {
    {{"", ""}}, {{"", ""}}, {{"Shift + ", "Umschalt + "}}, {{"Ctrl + ", "Strg + "}}};  // by KeyUse::With
constexpr texts::Wording to_word{{" to ", " bis "}}, twice_word{{"twice", "zweimal"}};

std::string in_table(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

}  // namespace

Words::Words(std::string verb, const std::string& text) : verb_(std::move(verb)) {
  std::istringstream in(text);
  for (std::string w; in >> w;) words_.push_back(w);
}

Words::Words(const std::string& line) : Words("", line) {
  if (words_.empty()) return;
  verb_ = words_.front();
  words_.erase(words_.begin());
}

std::string Words::word() { return more() ? words_[next_++] : ""; }

double Words::number() {
  double v = 0;
  std::istringstream in(word());
  if (!(in >> v) || !in.eof() || !std::isfinite(v)) throw Error(ExitCode::usage, "", verb_, "a number is missing");
  return v;
}

Vec3 Words::point() {
  const double x = number(), y = number();
  return {x, y, number()};
}

bool Words::on(bool now) {
  const std::string w = word();
  if (w != "on" && w != "off" && w != "toggle") throw Error(ExitCode::usage, "", verb_, "must be on or off");
  return w == "toggle" ? !now : w == "on";
}

Reply act(const Action& action, Player& player, Screen& screen, const std::string& words) {
  if (texts::Answer why = action.why_not(player)) return why;
  Words given(action.name, words);
  return action.run(player, screen, given);
}

std::string answer_line(const std::string& line, Player& player, Screen& screen) {
  Words words(line);
  try {
    for (const Action& a : all_actions()) {
      if (a.name != words.verb() || a.name.empty()) continue;
      Reply reply = a.why_not(player);
      if (!reply.fault) reply = a.run(player, screen, words);
      if (reply.fault) return "error: " + texts::text_of(*reply.fault, texts::Language::english);
      return reply.told.empty() ? "ok" : reply.told;
    }
  } catch (const Error& e) {
    return "error: " + (e.field().empty() ? "" : e.field() + ": ") + e.what();
  }
  return "error: " + texts::text_of({texts::NoteId::no_command, {words.verb()}}, texts::Language::english);
}

const Action& action_of(const std::string& name) {
  for (const Action& a : all_actions())
    if (a.name == name) return a;
  throw Error(ExitCode::internal, "", name, "there is no such action");
}

int last_numbered(int first) { return first == GLFW_KEY_1 ? GLFW_KEY_9 : GLFW_KEY_F8; }

std::string key_name(int key, texts::Language language) {
  for (const KeyWord& w : key_words)
    if (w.key == key) return w.name.of(language);
  if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25) return "F" + std::to_string(key - GLFW_KEY_F1 + 1);
  return std::string(1, char(key));  // GLFW's letters, figures and signs are those of ASCII
}

std::string keys_text(const Action& action, texts::Language language) {
  std::string text;
  KeyUse::With with = KeyUse::With::any;  // said once for keys that follow each other
  for (const KeyUse& use : action.keys) {
    std::string name = key_name(use.key, language);
    if (name.empty()) continue;
    if (use.how == KeyUse::How::numbered) name += to_word.of(language) + key_name(last_numbered(use.key), language);
    if (use.how == KeyUse::How::twice) name += std::string(", ") + twice_word.of(language);
    if (std::exchange(with, use.with) != use.with) name = with_words[int(use.with)].of(language) + name;
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

std::string keys_help(const Player& player, texts::Language language) {
  std::string text;
  for (const Action& a : all_actions())
    if (const std::string keys = keys_text(a, language); !keys.empty() && !a.why_not(player))
      text += (text.empty() ? "" : "\n") + keys + ": " + a.what.of(language);
  return text;
}

std::string keys_table(Action::Group group) {
  std::string table = "| | |\n|---|---|\n";
  for (const Action& a : all_actions())
    if (a.group == group && !a.keys.empty())
      table += "| " + keys_text(a, texts::Language::english) + " | " + a.what.of(texts::Language::english) + " |\n";
  return table;
}

std::string remote_table() {
  std::string table = "| line | |\n|---|---|\n";
  for (const Action& a : all_actions())
    if (!a.name.empty())
      table += "| `" + in_table(a.name + (a.arguments.empty() ? "" : " " + a.arguments)) + "` | " +
               in_table(a.what.of(texts::Language::english)) + " |\n";
  return table;
}

}  // namespace trephine::window
