// SPDX-License-Identifier: GPL-3.0-or-later
// What actions do that is more than a call.
#include "window/action_replies.h"

#include "base/error.h"

namespace trephine::window {
namespace {

constexpr std::size_t answered_notes = 8;

}  // namespace

// A command of the lesson that has the action's own name.
Reply command(Player& p, Words& w) { return p.lesson()->give(w.verb()); }

Reply move_arm(Player& p, Words& w) {
  const std::string how = w.word();
  for (const char* view : {"ap", "lateral", "oblique"})
    if (how == view) return p.lesson()->give("view_" + how);
  for (const char* turn : {"orbit_more", "orbit_less", "tilt_more", "tilt_less"})
    if (how == turn) return p.lesson()->give(how);
  return texts::Answer(texts::Note{texts::NoteId::no_arm_place, {how}});
}

Reply pause(Player& p, Words& w) {
  if (p.shown())
    p.shown()->paused = w.on(p.shown()->paused);
  else if (const bool on = w.on(p.lesson() && p.lesson()->paused()); p.lesson() && p.live()->begun())
    p.lesson()->give(on ? "pause" : "resume");
  return {};
}

Reply opacity(Player& p, Words& w) {
  const std::string anatomy = w.word();
  return p.view().set_opacity(anatomy, w.verb() == "show" ? 1 : w.verb() == "hide" ? 0 : w.number());
}

Reply zoom(Player& p, Words& w) {
  const double factor = w.number();
  if (!(factor > 0)) throw Error(ExitCode::usage, "", w.verb(), "the factor must be above 0");
  p.view().camera.zoom(factor);
  return {};
}

Reply cast_volume(Player& p, Words& w) {
  using Cast = scene::ViewParams::Cast;
  const std::string what = w.word();
  const std::string transfer = w.more() ? w.word() : "";
  if (what != "none" && what != "ct" && what != "haptic")
    throw Error(ExitCode::usage, "", w.verb(), "must be none, ct or haptic");
  p.view().stage().cast(what == "ct" ? Cast::ct : what == "haptic" ? Cast::haptic : Cast::none, transfer);
  return {};
}

std::vector<std::string> hu_choices(const Player& p) {
  const cases::LoadedCase& loaded = p.view().stage().loaded();
  std::vector<std::string> all;
  if (loaded.has_haptic() && loaded.haptic.encoding == voxel::HapticEncoding::hu) all.push_back("haptic");
  if (loaded.has_ct())
    for (const char* preset : {"bone", "skin", "vessels"}) all.push_back(std::string("ct ") + preset);
  return all;
}

std::vector<std::string> cast_choices(const Player& p) {
  std::vector<std::string> all = hu_choices(p);
  const cases::LoadedCase& loaded = p.view().stage().loaded();
  if (loaded.has_haptic() && loaded.haptic.encoding == voxel::HapticEncoding::occupancy) all.push_back("haptic");
  if (!all.empty()) all.insert(all.begin(), "none");
  return all;
}

Reply notes(Player& p, Screen& s, Words& w) {
  if (!w.more()) return notes_line(p.notes, answered_notes, s.language);
  const std::string asked = w.word();
  for (const auto& [name, language] : texts::languages())
    if (asked == name) return notes_line(p.notes, answered_notes, language);
  throw Error(ExitCode::usage, "", w.verb(), "the window has no language of that name");
}

}  // namespace trephine::window
