// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/action_when.h"

#include "window/action_replies.h"

namespace trephine::window {

texts::Answer without_recording(const Player& p) {
  if (p.shown()) return texts::NoteId::recording_shown;
  return p.lesson() && !(p.live() && p.live()->begun()) ? texts::Answer(texts::NoteId::not_now) : texts::Answer();
}

texts::Answer outside_lesson(const Player& p) {
  return p.in_lesson() ? texts::Answer(texts::NoteId::after_lesson) : texts::Answer();
}

texts::Answer of_lesson(const Player& p) {
  if (!p.lesson()) return texts::NoteId::no_lesson;
  return p.live() && p.live()->begun() ? texts::Answer() : texts::Answer(texts::NoteId::not_now);
}

texts::Answer with_question(const Player& p) {
  if (const texts::Answer not_here = of_lesson(p)) return not_here;
  return p.lesson()->questions().open(p.lesson()->facts()) >= 0 ? texts::Answer()
                                                                : texts::Answer(texts::NoteId::no_question);
}

texts::Answer of_arm(const Player& p) {
  if (!p.lesson()) return texts::NoteId::no_lesson;
  if (!p.lesson()->has_arm()) return texts::NoteId::no_arm;
  return p.xrays() ? of_lesson(p) : texts::Answer(texts::NoteId::no_ct);
}

texts::Answer with_drill(const Player& p) {
  if (p.shown()) return texts::NoteId::recording_shown;
  if (p.lesson()) return of_lesson(p);
  return p.live() && p.live()->cuts() ? texts::Answer() : texts::Answer(texts::NoteId::nothing_there);
}

texts::Answer with_burr(const Player& p) {
  if (const texts::Answer not_here = without_recording(p)) return not_here;
  return p.live() && p.live()->holds_burr() ? texts::Answer() : texts::Answer(texts::NoteId::nothing_there);
}

texts::Answer with_marker(const Player& p) {
  return p.live() && p.live()->draws() ? texts::Answer() : texts::Answer(texts::NoteId::nothing_there);
}

texts::Answer with_volume(const Player& p) {
  if (const texts::Answer not_here = outside_lesson(p)) return not_here;
  return hu_choices(p).empty() ? texts::Answer(texts::NoteId::no_volume) : texts::Answer();
}

texts::Answer with_rays(const Player& p) {
  if (const texts::Answer not_here = outside_lesson(p)) return not_here;
  return p.view().stage().cast_source().voxels() ? texts::Answer() : texts::Answer(texts::NoteId::nothing_cast);
}

}  // namespace trephine::window
