// SPDX-License-Identifier: GPL-3.0-or-later
// What the remote is told of a window's state.
#include <fmt/format.h>

#include <algorithm>

#include "window/actions.h"

namespace trephine::window {
namespace {

std::string of_picture(const fluoro::MadeFluoro& made, bool flipped) {
  const std::string text = flipped ? " flipped" : "";
  if (made.metal.empty()) return text;
  const auto tip = fluoro::CArm(made.arm, made.picture.size).project(made.metal[0].tip_mm);
  return fmt::format(" tip_px {:.2f} {:.2f}", flipped ? made.picture.size - tip[0] : tip[0], tip[1]) + text;
}

}  // namespace

std::string state_text(const Player& player) {
  const CaseView& view = player.view();
  const haptics::ServoFrame& f = view.frame();
  const bool tells = player.tells_tip();  // a surgeon is not told where the tip is
  const auto named = [&](int shape) { return !tells ? "hidden" : shape != 0 ? view.shape_name(shape) : "none"; };
  return fmt::format(
             "time {:.3f} tool {} tip {:.3f} {:.3f} {:.3f} in {} touching {} force {:.3f} depth {} faults {} "
             "incisions {} servo_hz {:.0f} tool_at {:.3f} {:.3f} {:.3f} axis {:.4f} {:.4f} {:.4f}",
             f.time_s, player.tool(), f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2], named(f.inside), named(f.touched),
             norm(Vec3{f.force_n[0], f.force_n[1], f.force_n[2]}),
             tells ? fmt::format("{:.2f}", view.depth_mm()) : "hidden", f.faults,
             player.live() ? player.live()->incisions().size() : player.shown()->playback().incisions().size(),
             player.live() ? player.live()->servo_hz() : 0, f.tip_mm[0], f.tip_mm[1], f.tip_mm[2], f.axis[0], f.axis[1],
             f.axis[2]) +
         (view.behind_mm() ? fmt::format(" behind_mm {:.2f}", *view.behind_mm()) : "") +
         (player.live() && player.live()->holds_burr() ? fmt::format(" burr_mm {:g}", player.live()->burr_mm()) : "");
}

std::string lesson_text(const Player& player) {
  const LessonController* lesson = player.lesson();
  if (!lesson) return "error: " + texts::text_of(texts::NoteId::no_lesson, texts::Language::english);
  const lessons::LessonFacts& f = lesson->facts();
  std::string text =
      fmt::format("time {:.2f} tool {} step {}", f.procedure_s(), lesson->tool().name, lesson->step() + 1);
  for (const lessons::LessonStatus& s : lesson->status()) text += " " + s.name + " " + s.value;
  text += fmt::format(" end {}", lesson->ended() ? lessons::name_of(f.end) : "none");
  if (lesson->paused()) text += " paused";
  if (const int verdict = lesson->verdict(); verdict != 0) text += verdict > 0 ? " green" : " red";
  if (const int n = lesson->questions().open(f); n >= 0) {
    const haptics::AskedQuestion& asked = lesson->questions().asked()[std::size_t(n)];
    text += " question " + asked.question;
    for (const std::string& choice : asked.choices) text += " " + choice;
  }
  if (const lessons::ScoredLesson* s = lesson->scored()) {
    std::string outcome = lessons::name_of(s->score.outcome());
    std::replace(outcome.begin(), outcome.end(), ' ', '_');
    text += fmt::format(" points {} of {} outcome {}", lessons::sum_of(s->score).points, lessons::sum_of(s->score).most,
                        outcome);
  }
  return text;
}

std::string xray_text(const Player& player) {
  const XrayPictures* pictures = player.xrays();
  if (!pictures) return "error: there is no C-arm";
  const fluoro::MadeFluoro* last = pictures->last();
  if (const ShotReview* review = player.shots()) {
    const int n = review->shown();
    std::string text = fmt::format("review shot {} of {}", n + 1, review->shots().size());
    if (n < 0) return text;
    const lessons::LessonShot& s = review->shots()[std::size_t(n)];
    text += fmt::format(" begin_s {:.3f} end_s {:.3f} view {} orbit_deg {:g} tilt_deg {:g} pictures {}", s.begin_s,
                        s.end_s, s.seen.view, s.seen.orbit_deg, s.seen.tilt_deg, pictures->made());
    return last ? text + fmt::format(" size_px {}", last->picture.size) + of_picture(*last, pictures->flipped) : text;
  }
  const lessons::LessonXray x = player.lesson()->xray();
  const std::string text = fmt::format(
      "{} view {} orbit_deg {:g} tilt_deg {:g} exposure_s {:.3f} shots_count {} pictures {}", x.on ? "on" : "off",
      x.now.view, x.now.orbit_deg, x.now.tilt_deg, x.exposure_s, x.shots_count, pictures->made());
  if (!last) return text;
  return text + fmt::format(" size_px {} waited_s {:.3f}", last->picture.size, last->waited_s) +
         of_picture(*last, pictures->flipped);
}

}  // namespace trephine::window
