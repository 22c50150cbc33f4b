// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/player.h"

#include <fmt/format.h>

#include <algorithm>

#include "window/ways.h"

namespace trephine::window {

namespace {

texts::NoteId outcome_note(const lessons::LessonScore& score) {
  switch (score.outcome()) {
    case lessons::LessonOutcome::completed:
      return texts::NoteId::outcome_completed;
    case lessons::LessonOutcome::failed:
      return texts::NoteId::outcome_failed;
    case lessons::LessonOutcome::not_completed:
      break;
  }
  return texts::NoteId::outcome_not_completed;
}

}  // namespace

Player::Player(const PlayOptions& options, const std::atomic<bool>& stop) : options_(options), stop_(stop) {
  session::SessionOptions& o = options_.session;
  if (!options_.playback.empty()) {
    shown_ = std::make_unique<ShownRecording>(std::make_unique<session::Playback>(
        o.case_folder, options_.playback, options_.before, cases::LoadParts{true}, Progress({}, &stop)));
    patient_ = shown_->playback().patient();
  } else {
    patient_ = std::make_shared<session::Patient>(o.case_folder, o.shape, o.contact, cases::LoadParts{true});
  }
  if (!options_.ghost.empty()) ghost_mm_ = way_of(options_.ghost, patient_->felt.loaded.manifest.case_token);
  if (options_.lesson) lesson_ = std::make_unique<LessonController>(*options_.lesson, *patient_, o);
  if (lesson_ && lesson_->has_arm() && patient_->felt.loaded.has_ct()) {
    xrays_ = std::make_unique<XrayPictures>(patient_);
    // As who stands behind the patient sees it.
    xrays_->flipped = lesson_->field({}).from.y > 0;
  }
}

void Player::make_view(std::shared_ptr<session::Patient> patient, const scene::ViewParams& params) {
  view_ = std::make_unique<CaseView>(std::move(patient), params);
  ++stages_;
  told_notes_ = 0;
}

void Player::set_stage() {
  scene::ViewParams params = options_.view;
  if (lesson_) {  // nothing is seen that a surgeon would not see
    params.view_site = params.opacity = "";
    params.cut = scene::ViewParams::Cut::none;
    params.cast = scene::ViewParams::Cast::none;
    params.transfer = "";
    params.places = params.insets = false;
  }
  make_view(patient_, params);
  if (lesson_) {
    for (double& opacity : view_->stage().state.opacity) opacity = 1;
    Theatre(*lesson_).show(*view_);
    if (params.view == scene::ViewPreset::surgeon) view_->set_view("surgeon");  // where the lesson's surgeon stands
  } else
    view_->stage().state.ghost_mm = ghost_mm_;
  if (shown_) {
    view_->show_target(session::target_of(shown_->playback().header(), *patient_));
    shown_->show_tool(*view_);
    view_->look_at(shown_->playback().frame());
    return;
  }
  live_ = std::make_unique<LiveSession>(options_.session, options_.hand, options_.view.view_site, patient_, *view_,
                                        lesson_.get(), notes);
  live_->begin();
}

void Player::step(double wall_s) {
  if (shown_) {
    shown_->step(wall_s, *view_);
    if (shots_) shots_->show(shown_->playback().time_s(), *xrays_);
  } else {
    live_->window_place = window_place;
    live_->step(wall_s);
    if (live_->failed() || (live_->stopped() && !(lesson_ && lesson_->ended()))) quit();
    if (xrays_) xrays_->follow(lesson_->xray());
    if (lesson_ && lesson_->ended() && !judged_) {
      live_->end();
      judged_ = true;
      lesson_->judge(true, stop_);
    }
    if (lesson_ && lesson_->judging() && lesson_->take_judged(false)) begin_review();
  }
  view_->follow();
  for (; told_notes_ < view_->stage().notes().size(); ++told_notes_) notes.add(view_->stage().notes()[told_notes_]);
}

void Player::finish() {
  if (live_) live_->end();
  if (!lesson_ || shown_ || !live_ || !live_->recorded() || stop_.load(std::memory_order_relaxed)) return;
  if (!judged_) lesson_->judge(false, stop_);
  judged_ = true;
  lesson_->take_judged(true);
}

void Player::begin_review() {
  faults_ = live_->faults();
  live_.reset();
  shown_ = std::make_unique<ShownRecording>(lesson_->take_review());
  const scene::OrbitCamera camera = view_->camera;
  view_.reset();  // graphics memory holds one
  make_view(shown_->playback().patient(), options_.view);
  view_->camera = camera;
  view_->stage().state.ghost_mm = ghost_mm_;
  haptics::Recording own;
  own.header = shown_->playback().header();
  own.frames = shown_->playback().frames();
  view_->stage().state.trace_mm = way_of(own);
  shown_->go_to(shown_->playback().end_s());
  shown_->paused = true;
  // Where a tool was last in the patient, or on it.
  const auto last = [&](const auto& was) { return std::find_if(own.frames.rbegin(), own.frames.rend(), was); };
  auto in = last([](const haptics::ServoFrame& f) { return f.inside != 0; });
  if (in == own.frames.rend()) in = last([](const haptics::ServoFrame& f) { return f.touched != 0; });
  if (in != own.frames.rend())
    view_->cut_along({in->proxy_mm[0], in->proxy_mm[1], in->proxy_mm[2]},
                     normalized({in->axis[0], in->axis[1], in->axis[2]}));
  if (xrays_) shots_ = std::make_unique<ShotReview>(lesson_->shots());
  shown_->show_tool(*view_);
  Theatre theatre(*lesson_);
  theatre.show(*view_);
  view_->stage().state.drops.clear();  // they are of the moment, which a review leaves
  shown_->bleed(theatre.bleedings(), lesson_->field(view_->middle_mm()).down);
  const lessons::ScoreSum sum = lessons::sum_of(lesson_->scored()->score);
  texts::Note note{texts::NoteId::judged,
                   {std::to_string(sum.points), std::to_string(sum.most)},
                   {outcome_note(lesson_->scored()->score)}};
  if (const std::string page = lesson_->lesson().report.page.string(); !page.empty()) {
    note.id = texts::NoteId::judged_in;
    note.values.insert(note.values.begin(), page);
  }
  notes.add(note);
}

std::vector<std::string> Player::tools() const {
  std::vector<std::string> names;
  if (lesson_)
    for (const haptics::BeltToolParams& t : lesson_->tools()) names.push_back(t.name);
  else
    for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) names.push_back(kind.name);
  return names;
}

std::filesystem::path Player::next_file(const std::string& stem, const std::string& ending) const {
  std::filesystem::path file;
  int n = 0;
  do file = options_.shots / fmt::format("{}-{:03}{}", stem, ++n, ending);
  while (std::filesystem::exists(file));
  return file;
}

}  // namespace trephine::window
