// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/player.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "surface/bounds.h"
#include "window/ways.h"

namespace trephine {
namespace {

constexpr double begin_mm = 15;    // before the site, where the tool waits
constexpr double beyond_mm = 150;  // so far outside the depth of the tip is measured from
constexpr double drop_mm = 60;     // up to this distance the place where the tool would land is lit
constexpr std::size_t most_forces = 240;
constexpr int xray_px = 512;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

bool can_cut(const Patient& p) {
  if (p.felt.loaded.haptic.encoding != HapticEncoding::occupancy) return false;
  const auto& shapes = p.felt.loaded.manifest.haptic.shapes;
  return std::any_of(shapes.begin(), shapes.end(), [](const CaseShape& s) { return s.cuttable; });
}

// "a.servo", "a-2.servo", ...: one recording for each tool that is taken.
std::filesystem::path numbered(const std::filesystem::path& file, int n) {
  if (n <= 1) return file;
  return file.parent_path() / (file.stem().string() + "-" + std::to_string(n) + file.extension().string());
}

}  // namespace

Player::Player(const PlayOptions& options, const std::atomic<bool>& stop) : options_(options), stop_(stop) {
  SessionOptions& o = options_.session;
  if (!options_.playback.empty()) {
    playback_ = std::make_unique<Playback>(o.case_folder, options_.playback, options_.before, LoadParts{true},
                                           Progress({}, &stop));
    patient_ = playback_->patient();
  } else {
    patient_ = std::make_shared<Patient>(o.case_folder, o.shape, o.contact, LoadParts{true});
  }
  if (!options_.ghost.empty()) ghost_mm_ = way_of(options_.ghost, patient_->felt.loaded.manifest.case_token);
  if (options_.lesson) desk_ = std::make_unique<LessonDesk>(*options_.lesson, *patient_, o);
  if (desk_ && desk_->has_arm() && patient_->felt.loaded.has_ct())
    fluoro_ = std::make_unique<FluoroThread>(patient_->felt.loaded.ct, xray_px);
}

// During a lesson nothing is seen that a surgeon would not see.
void Player::make_stage() {
  const LoadedCase& loaded = patient_->felt.loaded;
  ViewParams view = options_.view;
  const bool works = desk_ && !playback_;
  if (works) {
    view.view_site = view.opacity = "";
    // Where a C-arm stands, the surgeon works from behind.
    if (desk_->has_arm() && view.view == ViewPreset::surgeon) view.view = ViewPreset::back;
    view.cut = ViewParams::Cut::none;
    view.places = view.insets = false;
  }
  stage_ = std::make_unique<Stage>(loaded, view, patient_->uncut.get());
  ++stages_;
  told_notes_ = 0;
  if (works)
    for (double& opacity : stage_->state.opacity) opacity = 1;
  else
    stage_->state.ghost_mm = ghost_mm_;
  if (stages_ == 1) camera = camera_of(view, loaded.manifest, stage_->scene());
}

void Player::set_stage() {
  const LoadedCase& loaded = patient_->felt.loaded;
  make_stage();
  for (const CaseShape& s : loaded.manifest.haptic.shapes) shapes_[s.number] = s.name;
  tool_name_ = options_.session.tool.tool;
  if (playback_) {
    tool_name_ = playback_->tool_name();
    stage_->set_tool(playback_->tool());
    look_at(playback_->frame());
    return;
  }
  const Bounds& b = stage_->scene().bounds;
  goal_.tip_mm = {(b.min_mm.x + b.max_mm.x) / 2, (b.min_mm.y + b.max_mm.y) / 2, b.max_mm.z + begin_mm};
  if (desk_ && desk_->has_arm()) {  // behind the patient, pointing forwards
    goal_.axis = {0, 1, 0};
    goal_.tip_mm = {(b.min_mm.x + b.max_mm.x) / 2, b.max_mm.y + begin_mm, (b.min_mm.z + b.max_mm.z) / 2};
  }
  // The way to the target is what a lesson asks for.
  const std::string site = desk_ ? "" : options_.view.view_site;
  if (const auto a = approach_of(loaded.manifest, stage_->scene(), site)) {
    goal_.axis = -a->direction;
    goal_.tip_mm = a->site_mm + goal_.axis * begin_mm;
  }
  begin_session();
}

Player::~Player() {
  end_ = true;
  if (coming_.valid()) coming_.wait();
  session_.reset();
}

void Player::begin_session() {
  SessionOptions o = options_.session;
  session_faults_ = 0;
  o.watched = true;
  o.view = view_;
  o.begin = frame_.tick > 0 ? HandBegin{vec(frame_.tip_mm), normalized(vec(frame_.axis))}
                            : HandBegin{goal_.tip_mm, goal_.axis};
  if (desk_) {
    desk_->set_session(o);
  } else {
    if (!o.record.empty()) o.record = numbered(o.record, ++sessions_);
    o.drilling.drill = options_.session.drilling.drill && tool_kind(o.tool.tool).cuts() && can_cut(*patient_);
    o.begins_sha256 = begins_sha256_;
  }
  stage_->set_tool(desk_ ? whole_tool(desk_->tool()) : own_tool(o.tool));
  if (desk_) tool_name_ = desk_->tool().name;
  screen_hand_ = nullptr;
  const bool own = o.device.name.empty();
  if (own) {
    o.device.name = "screen";
    o.own_device = [this](const DeviceScene&) {
      auto hand = std::make_unique<ScreenHand>(options_.hand, goal_);
      screen_hand_ = hand.get();
      return hand;
    };
  }
  end_ = false;
  // A device may have to be waited for; the window goes on meanwhile.
  coming_ = std::async(own ? std::launch::deferred : std::launch::async, [this, o] {
    const auto say = [this](const std::string& line) {
      const std::lock_guard<std::mutex> lock(said_mutex_);
      said_.push_back(line);
    };
    return std::make_unique<Session>(o, end_, say, patient_);
  });
  if (own) meet_session();
}

// Takes the session once it is there.
void Player::meet_session() {
  {
    const std::lock_guard<std::mutex> lock(said_mutex_);
    for (const std::string& line : said_) note(line);
    said_.clear();
  }
  if (!coming_.valid() || coming_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
  try {
    session_ = coming_.get();
  } catch (...) {  // the session could not begin and took the hand with it; a window without a hand is of no use
    screen_hand_ = nullptr;
    quit_ = true;
    throw;
  }
  watch_ = std::make_unique<IncisionWatch>(session_->header());
  session_->start();
  rate_ticks_ = 0;
  press_as_needed();
}

void Player::end_session() {
  end_ = true;
  if (coming_.valid()) {
    try {
      coming_.get();  // it never began
    } catch (const Cancelled&) {
    }
    return;
  }
  if (!session_) return;
  const SessionResult r = session_->finish();
  for (const ServoFrame& f : session_->last_frames()) watch_->look(f, incisions_);
  session_.reset();
  recorded_ = true;
  screen_hand_ = nullptr;
  const ServoStatistics& t = r.statistics;
  told_faults_ |= t.faults;
  note(fmt::format(
      "{}: {} ticks, tick time p50 {:.1f}, p99 {:.1f} us, woken late p50 {:.3f}, p99 {:.3f} ms, {} overruns{}",
      desk_ ? r.header.lesson : r.header.tool.tool, t.ticks, t.busy.quantile_ns(0.5) / 1e3,
      t.busy.quantile_ns(0.99) / 1e3, t.late.quantile_ns(0.5) / 1e6, t.late.quantile_ns(0.99) / 1e6, t.overruns,
      t.faults != 0 ? ", faults " + fault_names(t.faults) : ""));
  if (r.frames_lost > 0) note(fmt::format("{} frames were not recorded: the disk is too slow", r.frames_lost));
  if (!r.outcome) return;
  std::string removed;
  for (const auto& [name, mm3] : r.outcome->removed_mm3)
    removed += fmt::format("{}{} {:.1f} mm3", removed.empty() ? "" : ", ", name, mm3);
  if (!removed.empty()) begins_sha256_ = r.outcome->volume_sha256;
  if (!removed.empty()) note(fmt::format("{} removed {}", desk_ ? r.header.lesson : r.header.tool.tool, removed));
}

void Player::finish() {
  end_session();
  if (!desk_ || !recorded_ || stop_.load(std::memory_order_relaxed)) return;
  if (!judged_) desk_->judge(false, stop_);
  judged_ = true;
  desk_->take_judged(true);
}

void Player::aim() {
  if (screen_hand_) screen_hand_->aim(goal_);
}

void Player::look_at(const ServoFrame& frame) {
  frame_ = frame;
  stage_->show_frame(frame);
}

void Player::step(double wall_s) {
  wall_s_ += wall_s;
  if (playback_) {
    if (!paused_) playback_->go_to(playback_->time_s() + wall_s * speed);
    std::size_t count = 0;
    for (const IncisionMark& m : playback_->incisions()) count += m.time_s <= playback_->time_s();
    stage_->show_incisions(playback_->incisions(), count);
    if (playback_->tool_name() != tool_name_) {
      tool_name_ = playback_->tool_name();
      stage_->set_tool(playback_->tool());
    }
    look_at(playback_->frame());
    follow_review_xray();
  } else {
    view_->write({camera.right(), camera.up, goal_.least_most_n});
    meet_session();
    if (session_) follow_session();
    follow_xray();
    if (desk_ && desk_->judging() && desk_->take_judged(false)) begin_review();
  }
  stage_->follow(patient_->marks);
  stage_->follow_coarse();
  for (; told_notes_ < stage_->notes().size(); ++told_notes_) note(stage_->notes()[told_notes_]);
  for (CtPlane& plane : stage_->state.ct_planes) plane.point_mm = vec(frame_.proxy_mm);
  measure();
}

void Player::follow_session() {
  const std::vector<ServoFrame>& frames = session_->take_frames();
  late_us_ = 0;
  bool marked = false;
  for (const ServoFrame& f : frames) {
    watch_->look(f, incisions_);
    late_us_ = std::max(late_us_, double(f.late_us));
    marked = marked || (f.buttons & Drilling::mark);
    if (!desk_) ink(f);
  }
  if (marked && (goal_.buttons & Drilling::mark)) {  // the servo has seen the button: it is released
    goal_.buttons &= ~Drilling::mark;
    aim();
  }
  if (!frames.empty()) {  // else the last frame may be of the session before this one
    look_at(frames.back());
    told_faults_ |= frame_.faults;
    if (const std::uint32_t faults = frame_.faults & ~session_faults_; faults != 0) {
      session_faults_ |= faults;
      note("fault: " + fault_names(faults) + ": the force is zero from now on");
    }
  }
  if (incisions_.size() > Renderer::most_incisions && !many_incisions_) {
    many_incisions_ = true;
    note(fmt::format("more than {} incisions: the oldest look closed, and are not", Renderer::most_incisions));
  }
  stage_->show_incisions(incisions_, incisions_.size());
  if (wall_s_ - rate_wall_s_ > 0.5) {
    servo_hz_ = rate_ticks_ > 0 ? double(frame_.tick - rate_ticks_) / (wall_s_ - rate_wall_s_) : 0;
    rate_ticks_ = frame_.tick;
    rate_wall_s_ = wall_s_;
  }
  if (!session_->running() && !desk_) quit_ = true;
  if (desk_) follow_lesson(frames);
}

// What the panel says of the tool, and the place where it would land.
void Player::measure() {
  const Vec3 tip = vec(frame_.proxy_mm), axis = normalized(vec(frame_.axis));
  forces_.push_back(float(norm(vec(frame_.force_n))));
  if (forces_.size() > most_forces) forces_.pop_front();
  const TouchableFaces faces = visible_faces();
  const Contact first = patient_->contact.intersect(tip + axis * beyond_mm, tip, faces);
  depth_mm_ = first.hit ? norm(first.point_mm - tip) : 0;
  if (!stage_->state.contact_mm) {
    const Contact below = patient_->contact.intersect(tip, tip - axis * drop_mm, faces);
    if (below.hit) {
      stage_->state.contact_mm = below.point_mm;
      stage_->state.contact_strength = 0;
    }
  }
  target_mm_ = -1;
  for (const CaseTarget& t : patient_->felt.loaded.manifest.targets) {
    const double away = norm(t.position_mm - tip);
    if (target_mm_ < 0 || away < target_mm_) target_mm_ = away;
  }
  std::vector<Vec3>& trace = stage_->state.trace_mm;
  if (tracing_) {
    if (!trace.empty() && norm(tip - last_trace_mm_) < 1e3) trace_mm_ += norm(tip - last_trace_mm_);
    last_trace_mm_ = tip;
    add_dot(trace, tip, trace_apart_mm_);
  }
}

TouchableFaces Player::visible_faces() const {
  TouchableFaces faces{0, 0};
  for (std::size_t n = 0; n < stage_->scene().surfaces.size(); ++n)
    if (const int shape = stage_->scene().surfaces[n].shape; shape > 0 && stage_->state.opacity[n] >= 0.5)
      faces.front |= std::uint64_t{1} << shape;
  return faces;
}

Contact Player::seen(double x, double y, int width, int height) const {
  const Bounds& b = stage_->scene().bounds;
  const EyeView eye = camera.eye(width, height, b);
  const Vec3 ray = eye.ray(x, y, width, height);
  Vec3 from = eye.eye_mm;
  const Vec3 to = from + ray * (eye.far_mm + norm(b.max_mm - b.min_mm));
  if (stage_->state.cut) {
    // The half that is cut away is not seen: the line of sight begins where it leaves that half.
    const CutPlane& c = *stage_->state.cut;
    const double before = dot(c.normal, from - c.point_mm), slope = dot(c.normal, ray);
    if (before > 0) {
      if (slope >= 0) return {};
      from += ray * (-before / slope);
    }
    // The cut itself is seen where it lies within a shape.
    const int at = patient_->contact.shape_at(from);
    if (before > 0 && at != 0 && (visible_faces().front >> at & 1)) {
      Contact c2;
      c2.hit = true;
      c2.point_mm = from;
      c2.normal = c.normal;
      c2.shape = at;
      return c2;
    }
  }
  return patient_->contact.intersect(from, to, visible_faces());
}

const std::string& Player::shape_name(int number) const {
  const auto found = shapes_.find(number);
  return found != shapes_.end() ? found->second : no_name_;
}

std::filesystem::path Player::next_shot() {
  std::filesystem::path file;
  do file = options_.shots / fmt::format("picture-{:03}.png", ++shots_);
  while (std::filesystem::exists(file));
  return file;
}

}  // namespace trephine
