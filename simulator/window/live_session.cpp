// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/live_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace trephine::window {
namespace {

constexpr double more_than_pierce = 1.25, most_of_device = 0.97;
constexpr double rate_over_s = 0.5;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

bool can_cut(const session::Patient& p) {
  const auto& shapes = p.felt.loaded.manifest.haptic.shapes;
  return std::any_of(shapes.begin(), shapes.end(), [](const cases::CaseShape& s) { return s.cuttable; });
}

// "a.servo", "a-2.servo", ...: one recording for each tool that is taken.
std::filesystem::path numbered(const std::filesystem::path& file, int n) {
  if (n <= 1) return file;
  return file.parent_path() / (file.stem().string() + "-" + std::to_string(n) + file.extension().string());
}

std::vector<texts::NoteId> words_of(std::uint32_t faults) {
  std::vector<texts::NoteId> words;
  for (int n = 0; n < haptics::haptic_fault::count; ++n)
    if (faults >> n & 1) words.push_back(texts::NoteId(int(texts::NoteId::fault_pose) + n));
  return words;
}

texts::Note ticks_of(const std::string& what, const haptics::ServoStatistics& t) {
  const auto us = [](const haptics::Histogram& h, double share) {
    return fmt::format("{:.1f}", h.quantile_ns(share) / 1e3);
  };
  const auto ms = [](const haptics::Histogram& h, double share) {
    return fmt::format("{:.3f}", h.quantile_ns(share) / 1e6);
  };
  return {t.faults != 0 ? texts::NoteId::ticks_with_faults : texts::NoteId::ticks,
          {what, std::to_string(t.ticks), us(t.busy, 0.5), us(t.busy, 0.99), ms(t.late, 0.5), ms(t.late, 0.99),
           std::to_string(t.overruns)},
          words_of(t.faults)};
}

}  // namespace

LiveSession::LiveSession(const session::SessionOptions& options, const ScreenHandParams& hand_params,
                         const std::string& site, std::shared_ptr<session::Patient> patient, CaseView& view,
                         LessonController* lesson, Notes& notes)
    // The way to the target is what a lesson asks for.
    : hand(view, lesson ? "" : site, lesson && lesson->has_arm()),
      options_(options),
      hand_params_(hand_params),
      patient_(std::move(patient)),
      view_(view),
      lesson_(lesson),
      notes_(notes),
      tool_name_(options.tool.tool) {
  if (lesson_) theatre_ = std::make_unique<Theatre>(*lesson_);
}

LiveSession::~LiveSession() {
  end_ = true;
  if (coming_.valid()) coming_.wait();
  session_.reset();
}

void LiveSession::begin() {
  session::SessionOptions o = options_;
  session_faults_ = second_faults_ = 0;
  o.watched = true;
  o.view = axes_;
  o.screen_view = screen_;
  tell_screen();
  const haptics::ServoFrame& f = view_.frame();
  o.begin = f.tick > 0 ? device::HandBegin{vec(f.tip_mm), normalized(vec(f.axis))}
                       : device::HandBegin{hand.goal().tip_mm, hand.goal().axis};
  if (lesson_) {
    lesson_->set_session(o);
    tool_name_ = lesson_->tool().name;
  } else {
    if (!o.record.empty()) o.record = numbered(o.record, ++sessions_);
    o.drilling.drill = options_.drilling.drill && haptics::tool_kind(o.tool.tool).cuts() && can_cut(*patient_);
    o.begins_sha256 = begins_sha256_;
    board_->buttons.store(0, std::memory_order_relaxed);
    o.board = board_;
  }
  view_.stage().set_tool(lesson_ ? haptics::own_tool(lesson_->tool()) : haptics::own_tool(o.tool));
  hand.hold_by(nullptr);
  const bool own = o.device.name.empty();
  if (own) {
    o.device.name = "screen";
    screen_hand_ = std::make_shared<ScreenHand*>(nullptr);
    o.own_device = [made = screen_hand_, params = hand_params_, goal = hand.goal()](const device::DeviceScene&) {
      auto screen = std::make_unique<ScreenHand>(params, goal);
      *made = screen.get();
      return screen;
    };
  }
  end_ = false;
  // A device may have to be waited for; the window goes on meanwhile.
  const bool at_once = own && !o.second;
  coming_ = std::async(at_once ? std::launch::deferred : std::launch::async, [this, o] {
    const auto hear = [this](const texts::Note& note) {
      const std::lock_guard<std::mutex> lock(heard_mutex_);
      heard_.push_back(note);
    };
    return std::make_unique<session::Session>(o, end_, hear, patient_);
  });
  if (at_once) meet();
}

// Takes the session once it is there.
void LiveSession::meet() {
  {
    const std::lock_guard<std::mutex> lock(heard_mutex_);
    for (const texts::Note& note : heard_) notes_.add(note);
    heard_.clear();
  }
  if (!coming_.valid() || coming_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
  try {
    session_ = coming_.get();
    if (const auto made = std::exchange(screen_hand_, nullptr)) hand.hold_by(*made);
  } catch (...) {  // the session could not begin and took the hand with it; a window without a hand is of no use
    hand.hold_by(nullptr);
    failed_ = true;
    throw;
  }
  const auto shape_at = session::shape_at_of(patient_);
  watch_ = std::make_unique<session::IncisionWatch>(session_->header(), shape_at);
  dust_watch_ = std::make_unique<scene::DustWatch>(
      dust_, session_->header(), haptics::drilled_shapes(patient_->felt.loaded.manifest.haptic), shape_at);
  const auto target = session::target_of(session_->header(), *patient_);
  target_watch_ = target ? std::make_unique<session::TargetWatch>(target) : nullptr;
  view_.show_target(target);
  session_->start();
  rate_ticks_ = 0;
  press_as_needed();
}

void LiveSession::end() {
  end_ = true;
  if (coming_.valid()) {
    try {
      coming_.get();  // it never began
    } catch (const Cancelled&) {
    }
    return;
  }
  if (!session_) return;
  const session::SessionResult r = session_->finish();
  for (const haptics::ServoFrame& f : session_->last_frames()) {
    watch_->look(f, incisions_);
    if (target_watch_) target_watch_->look(f);
  }
  session_.reset();
  recorded_ = true;
  hand.hold_by(nullptr);
  faults_ |= r.statistics.faults | (r.second ? r.second->faults : 0);
  const std::string what = lesson_ ? r.header.lesson : r.header.tool.tool;
  notes_.add(ticks_of(what, r.statistics));
  if (target_watch_)
    if (const session::TargetFigures t = target_watch_->figures(); t.seconds > 0)
      notes_.add({texts::NoteId::target_followed,
                  {fmt::format("{:.1f}", t.seconds), fmt::format("{:.2f}", t.mean_off_mm),
                   fmt::format("{:.2f}", t.mean_behind_mm), fmt::format("{:.3f}", t.mean_behind_s)}});
  if (r.frames_lost > 0) notes_.add({texts::NoteId::frames_lost, {std::to_string(r.frames_lost)}});
  if (!r.outcome) return;
  std::string removed;
  for (const auto& [name, mm3] : r.outcome->removed_mm3)
    removed += fmt::format("{}{} {:.1f} mm3", removed.empty() ? "" : ", ", name, mm3);
  if (removed.empty()) return;
  begins_sha256_ = r.outcome->volume_sha256;
  notes_.add({texts::NoteId::removed, {what, removed}});
}

texts::Answer LiveSession::take_tool(const std::string& name) {
  if (lesson_) return session_ ? lesson_->take(name) : texts::Answer(texts::NoteId::not_now);
  haptics::ToolParams next;
  next.tool = name;
  return take(next);
}

texts::Answer LiveSession::take(const haptics::ToolParams& next) {
  try {
    haptics::tool_kind(next.tool);
    haptics::make_tool(haptics::own_tool(next));
  } catch (const Error& e) {
    return texts::Note{texts::NoteId::verbatim, {e.what()}};
  }
  end();
  hand.press(~0u, false);
  tool_name_ = next.tool;
  options_.tool = next;
  begin();
  return {};
}

haptics::ToolParams LiveSession::held() const {
  return lesson_ ? haptics::own_tool(lesson_->tool()) : haptics::own_tool(options_.tool);
}

bool LiveSession::holds_burr() const { return haptics::tool_kind(held().tool).rotates(); }
double LiveSession::burr_mm() const { return held().tool_diameter_mm; }

texts::Answer LiveSession::change_burr(const std::string& asked) {
  std::vector<haptics::ToolParams> burrs;
  std::vector<std::string> names;
  if (lesson_)
    for (const haptics::BeltToolParams& t : lesson_->tools()) {
      if (!t.cuts) continue;
      burrs.push_back(haptics::own_tool(t));
      names.push_back(t.name);
    }
  else
    burrs = haptics::burr_library();
  const int n = haptics::other_burr(burrs, held(), asked);
  if (n < 0) return texts::NoteId::no_other_burr;
  return lesson_ ? take_tool(names[std::size_t(n)]) : take(haptics::with_burr(options_.tool, burrs[std::size_t(n)]));
}

void LiveSession::set_pedal(bool down) {
  if (lesson_) {
    if (session_) lesson_->set_pedal(down);
  } else if (haptics::tool_kind(tool_name_).cut ==
             haptics::ToolKind::Cut::incision) {  // it has no motor: it cuts where it is
    if (down) incise();
  } else {
    hand.press(haptics::Drilling::pedal, down);
  }
}

texts::Answer LiveSession::incise() {
  if (lesson_) return session_ ? lesson_->give("incise") : texts::Answer(texts::NoteId::not_now);
  hand.press(haptics::Drilling::mark, true);
  return {};
}

texts::Answer LiveSession::command(const std::string& name) {
  if (lesson_) return session_ ? lesson_->give(name) : texts::Answer(texts::NoteId::not_now);
  for (int n = 1; n < haptics::belt_command::count; ++n)
    if (name == haptics::belt_command::names[n])
      board_->buttons.store(std::uint32_t(n) << haptics::belt_button::command_shift, std::memory_order_relaxed);
  return {};
}

bool LiveSession::draws() const {
  return hand.by_screen() && (lesson_ ? lesson_->tool().marks : haptics::tool_kind(tool_name_).marks);
}

void LiveSession::step(double wall_s) {
  wall_s_ += wall_s;
  axes_->write({view_.camera.right(), view_.camera.up, hand.goal().min_most_n});
  tell_screen();
  meet();
  if (session_) follow();
}

void LiveSession::tell_screen() {
  const scene::OrbitCamera& c = view_.camera;
  const Vec3 right = c.right();
  screen_->write(device::over_screen({c.target_mm, right, normalized(cross(c.toward, right)), c.toward, c.mm_per_px(1)},
                                     window_place));
}

void LiveSession::follow() {
  const std::vector<haptics::ServoFrame>& frames = session_->take_frames();
  late_us_ = 0;
  bool marked = false, commanded = false;
  std::uint32_t second_faults = 0;
  const std::vector<haptics::ServoFrame>& second = session_->second_frames();
  const std::optional<haptics::RecordedSecondHand>& held = session_->header().second;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const haptics::ServoFrame& f = frames[n];
    watch_->look(f, incisions_);
    dust_watch_->look(f, view_.stage().view().dust, held ? &second[n] : nullptr);
    if (held) second_faults |= second[n].faults;
    if (target_watch_) target_watch_->look(f);
    late_us_ = std::max(late_us_, double(f.late_us));
    marked = marked || (f.buttons & haptics::Drilling::mark);
    commanded = commanded || haptics::belt_button::command(f.buttons) != haptics::belt_command::none;
    if (!lesson_) ink(f);
  }
  // The servo has seen the button: it is released.
  if (marked && hand.pressed(haptics::Drilling::mark)) hand.press(haptics::Drilling::mark, false);
  if (commanded) board_->buttons.store(0, std::memory_order_relaxed);
  const haptics::ServoFrame& shown = view_.frame();
  if (!frames.empty()) {  // else the last frame may be of the session before this one
    view_.look_at(frames.back(), held ? &*held : nullptr, held ? &second.back() : nullptr);
    faults_ |= shown.faults;
    follow_second(second_faults);
    if (const std::uint32_t faults = shown.faults & ~session_faults_; faults != 0) {
      session_faults_ |= faults;
      const std::uint32_t passing = faults & haptics::haptic_fault::passing, lasting = faults - passing;
      if (lasting != 0) notes_.add({texts::NoteId::force_is_zero, {}, words_of(lasting)});
      if (passing != 0) notes_.add({texts::NoteId::force_comes_back, {}, words_of(passing)});
    }
  }
  if (incisions_.size() > render::Renderer::max_incisions && !std::exchange(many_incisions_, true))
    notes_.add({texts::NoteId::many_incisions, {std::to_string(render::Renderer::max_incisions)}});
  view_.stage().show_incisions(incisions_, incisions_.size());
  view_.stage().show_dust(dust_);
  if (wall_s_ - rate_wall_s_ > rate_over_s) {
    servo_hz_ = rate_ticks_ > 0 ? double(shown.tick - rate_ticks_) / (wall_s_ - rate_wall_s_) : 0;
    rate_ticks_ = shown.tick;
    rate_wall_s_ = wall_s_;
  }
  if (lesson_) follow_lesson(frames);
}

void LiveSession::follow_second(std::uint32_t faults) {
  const std::uint32_t fresh = faults & ~second_faults_;
  second_faults_ |= faults;
  const std::uint32_t passing = fresh & haptics::haptic_fault::passing, lasting = fresh - passing;
  if (lasting != 0) notes_.add({texts::NoteId::second_force_is_zero, {}, words_of(lasting)});
  if (passing != 0) notes_.add({texts::NoteId::second_force_comes_back, {}, words_of(passing)});
}

void LiveSession::follow_lesson(const std::vector<haptics::ServoFrame>& frames) {
  lesson_->watch(frames, session_->drilling(), session_->second_frames());
  lesson_->take_ink(view_.stage().state.ink_mm);
  if (lesson_->tool().name != tool_name_) {
    tool_name_ = lesson_->tool().name;
    press_as_needed();
  }
  theatre_->follow(frames, view_);
  dust_watch_->bleed(theatre_->bleedings(), lesson_->field(view_.middle_mm()).down);
  // A device's second pedal goes on to the next step.
  bool second = false;
  for (const haptics::ServoFrame& f : frames) {
    const std::uint32_t before = std::exchange(seen_buttons_, f.buttons);
    second = second || ((f.buttons & haptics::Drilling::mark) && !(before & haptics::Drilling::mark));
  }
  if (second) lesson_->next();
}

double piercing_n(const haptics::BeltToolParams& tool, const cases::CaseHaptic& haptic, double max_force_n) {
  if (!(tool.pierce_n > 0)) return 0;
  double held_n = 0;
  for (const cases::CaseShape& s : haptic.shapes)
    held_n = std::max(held_n, s.material.tip_force_n + s.material.shaft_friction_n_per_mm * tool.tool_length_mm);
  return std::min(more_than_pierce * tool.pierce_n + held_n, most_of_device * max_force_n);
}

// A hand of mouse and keyboard usually presses no harder than a burr needs, which would never pierce bone.
void LiveSession::press_as_needed() {
  hand.pull_at_least(
      lesson_ ? piercing_n(lesson_->tool(), patient_->felt.loaded.manifest.haptic, session_->header().force.max_force_n)
              : 0);
}

// What a marker draws without a lesson.
void LiveSession::ink(const haptics::ServoFrame& f) {
  const std::uint32_t before = std::exchange(seen_buttons_, f.buttons);
  if (!haptics::tool_kind(tool_name_).marks || !(f.buttons & haptics::Drilling::pedal) || f.touched == 0) return;
  const Vec3 at = vec(f.proxy_mm);
  std::vector<Vec3>& dots = view_.stage().state.ink_mm;
  if (!(before & haptics::Drilling::pedal) || dots.empty()) {
    ink_mm_ = 0;
    dots.push_back(last_ink_mm_ = at);
  }
  const double step = norm(at - last_ink_mm_);
  if (step < 1) return;
  ink_mm_ += step;
  dots.push_back(last_ink_mm_ = at);
}

}  // namespace trephine::window
