// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/case_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "window/ways.h"

namespace trephine::window {
namespace {

constexpr double beyond_mm = 150;     // so far outside the depth of the tip is measured from
constexpr double drop_mm = 60;        // up to this distance the place where the tool would land is lit
constexpr double around_field = 1.8;  // of a lesson's field more is seen than of a site
constexpr double about_field = 1.2;   // of a field that lies on a back or a chest so much is seen
constexpr double least_room = 0.2;    // part of the picture's width
constexpr double leap_mm = 1e3;       // no trace is that long from one picture to the next
constexpr std::size_t max_forces = 240;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

CaseView::CaseView(std::shared_ptr<session::Patient> patient, const scene::ViewParams& params)
    : patient_(std::move(patient)), stage_(patient_->felt.loaded, params, patient_->uncut.get()) {
  camera = scene::camera_of(params, manifest(), stage_.scene());
  shapes_ = patient_->felt.shapes;
}

void CaseView::show_target(std::shared_ptr<const session::MovingTarget> target) {
  const bool first = !target_;
  target_ = std::move(target);
  if (first && target_ && stage_.view().view == scene::ViewPreset::surgeon) set_view("surgeon");
}

texts::Answer CaseView::set_view(const std::string& preset) {
  if (preset == "surgeon" && stands_from) {
    camera.look_from(*stands_from, stage_.scene().bounds);
    const std::optional<scene::TheatreField>& field = stage_.state.theatre;
    if (field && field->open_mm > 0) camera.show(field->centre_mm, about_field * field->open_mm);
    camera.zoom(fit_);
    return {};
  }
  const std::optional<Vec3> work_mm = open_field_mm ? open_field_mm
                                      : target_     ? std::optional<Vec3>(target_->first_mm())
                                                    : std::nullopt;
  if (preset == "surgeon" && work_mm && norm(middle_mm() - *work_mm) > 1) {
    const surface::Bounds& b = stage_.scene().bounds;
    camera.look(scene::ViewPreset::surgeon, b, work_mm, normalized(middle_mm() - *work_mm), 0);
    camera.zoom(around_field);
    return {};
  }
  for (const auto& [name, value] : scene::view_presets())
    if (name == preset) {
      scene::ViewParams v = stage_.view();
      v.view = value;
      const double aside = camera.aside_ratio;
      camera = scene::camera_of(v, manifest(), stage_.scene());
      camera.aside_ratio = aside;
      camera.zoom(fit_);
      return {};
    }
  return texts::Note{texts::NoteId::no_view, {preset}};
}

void CaseView::set_room(double from_px, double to_px, int width, int height) {
  if (!stands_from || width <= 0 || height <= 0) return;
  // With letters so large that hardly any room is left, the panels are moved or hidden to see the patient.
  if (!(to_px - from_px >= least_room * width)) from_px = 0, to_px = width;
  const double room = to_px - from_px;
  camera.aside_ratio = 0.5 * (from_px + to_px) / width - 0.5;
  // The camera fits what it shows to the picture's shorter side.
  const double fit = std::max(1.0, std::min(width, height) / room);
  camera.zoom(fit / std::exchange(fit_, fit));
}

texts::Answer CaseView::set_opacity(const std::string& anatomy, double opacity) {
  const int n = stage_.scene().find(anatomy);
  if (n < 0) return texts::Note{texts::NoteId::no_anatomy, {anatomy}};
  if (!(opacity >= 0 && opacity <= 1)) return texts::NoteId::no_opacity;
  stage_.state.opacity[std::size_t(n)] = opacity;
  return {};
}

texts::Answer CaseView::cut(const std::string& how) {
  if (how == "none") {
    stage_.state.cut.reset();
    return {};
  }
  const std::map<std::string, Vec3> normals{
      {"tool", normalized(vec(frame_.axis))}, {"axial", {0, 0, 1}}, {"coronal", {0, -1, 0}}, {"sagittal", {1, 0, 0}}};
  const auto found = normals.find(how);
  if (found == normals.end()) return texts::Note{texts::NoteId::no_cut, {how}};
  stage_.state.cut = scene::CutPlane{vec(frame_.proxy_mm), found->second};
  return {};
}

void CaseView::cut_along(Vec3 tip, Vec3 axis) {
  int across = 0;  // the patient's axis that is farthest from the tool's
  for (int a = 1; a < 3; ++a)
    if (std::abs(axis[a]) < std::abs(axis[across])) across = a;
  Vec3 out;
  out[across] = camera.toward[across] < 0 ? -1 : 1;
  out = normalized(out - axis * dot(out, axis));
  stage_.state.cut = scene::CutPlane{tip, out};
  camera.target_mm = tip;
  camera.toward = out;
  camera.up = axis;
}

void CaseView::move_cut(double mm) {
  if (stage_.state.cut) stage_.state.cut->point_mm += normalized(stage_.state.cut->normal) * mm;
}

void CaseView::show_places(bool shown) {
  stage_.state.markers = shown ? scene::places_of(manifest()) : std::vector<scene::Marker>();
}

void CaseView::show_slices(bool shown) {
  stage_.state.ct_planes.clear();
  if (shown)
    for (int axis = 0; axis < 3; ++axis) stage_.state.ct_planes.push_back({axis, vec(frame_.proxy_mm)});
}

void CaseView::trace(bool on) {
  traces_ = on;
  if (!on) return;
  stage_.state.trace_mm.clear();
  trace_mm_ = 0;
  trace_apart_mm_ = 1;
}

void CaseView::look_at(const haptics::ServoFrame& frame, const haptics::RecordedSecondHand* held,
                       const haptics::ServoFrame* second) {
  frame_ = frame;
  stage_.show_frame(frame, held, second);
  stage_.state.moving = scene::moving_of(target_.get(), frame.time_s);
}

std::optional<double> CaseView::behind_mm() const {
  if (!target_ || !target_->runs(frame_.time_s)) return std::nullopt;
  return target_->behind_mm(frame_.time_s, vec(frame_.proxy_mm));
}

void CaseView::follow() {
  stage_.follow(patient_->marks);
  stage_.follow_coarse();
  const Vec3 tip = vec(frame_.proxy_mm), axis = normalized(vec(frame_.axis));
  for (scene::CtPlane& plane : stage_.state.ct_planes) plane.point_mm = tip;
  forces_.push_back(float(norm(vec(frame_.force_n))));
  if (forces_.size() > max_forces) forces_.pop_front();
  const contact::TouchableFaces faces = visible_faces();
  const contact::Contact first = patient_->contact.intersect(tip + axis * beyond_mm, tip, faces);
  depth_mm_ = first.hit ? norm(first.point_mm - tip) : 0;
  if (!stage_.state.contact_mm) {
    const contact::Contact below = patient_->contact.intersect(tip, tip - axis * drop_mm, faces);
    if (below.hit) {
      stage_.state.contact_mm = below.point_mm;
      stage_.state.contact_strength = 0;
    }
  }
  const cases::CaseTarget* target = nearest_target(tip);
  target_mm_ = target ? norm(target->position_mm - tip) : -1;
  if (!traces_) return;
  std::vector<Vec3>& way = stage_.state.trace_mm;
  if (!way.empty() && norm(tip - last_trace_mm_) < leap_mm) trace_mm_ += norm(tip - last_trace_mm_);
  last_trace_mm_ = tip;
  add_dot(way, tip, trace_apart_mm_);
}

const cases::CaseTarget* CaseView::nearest_target(Vec3 to) const {
  const cases::CaseTarget* nearest = nullptr;
  for (const cases::CaseTarget& t : manifest().targets)
    if (!nearest || norm(t.position_mm - to) < norm(nearest->position_mm - to)) nearest = &t;
  return nearest;
}

contact::TouchableFaces CaseView::visible_faces() const {
  contact::TouchableFaces faces{0, 0};
  for (std::size_t n = 0; n < stage_.scene().surfaces.size(); ++n)
    if (const int shape = stage_.scene().surfaces[n].shape; shape > 0 && stage_.state.opacity[n] >= 0.5)
      faces.front |= std::uint64_t{1} << shape;
  return faces;
}

contact::Contact CaseView::seen(const Cursor& at) const {
  const surface::Bounds& b = stage_.scene().bounds;
  const scene::EyeView view = eye(at);
  const Vec3 ray = view.ray(at.x, at.y, at.width, at.height);
  Vec3 from = view.eye_mm;
  const Vec3 to = from + ray * (view.far_mm + norm(b.max_mm - b.min_mm));
  if (stage_.state.cut) {
    // The half that is cut away is not seen: the line of sight begins where it leaves that half.
    const scene::CutPlane& c = *stage_.state.cut;
    const double before = dot(c.normal, from - c.point_mm), slope = dot(c.normal, ray);
    if (before > 0) {
      if (slope >= 0) return {};
      from += ray * (-before / slope);
    }
    // The cut itself is seen where it lies within a shape.
    const int shape = patient_->contact.shape_at(from);
    if (before > 0 && shape != 0 && (visible_faces().front >> shape & 1)) {
      contact::Contact on_cut;
      on_cut.hit = true;
      on_cut.point_mm = from;
      on_cut.normal = c.normal;
      on_cut.shape = shape;
      return on_cut;
    }
  }
  return patient_->contact.intersect(from, to, visible_faces());
}

std::string CaseView::under(const Cursor& cursor) const {
  const contact::Contact c = seen(cursor);
  if (!c.hit) return "";
  return fmt::format("{}, {:.1f} {:.1f} {:.1f} mm", shape_name(c.shape), c.point_mm.x, c.point_mm.y, c.point_mm.z);
}

const std::string& CaseView::shape_name(int number) const {
  static const std::string none;
  const auto found = shapes_.find(number);
  return found != shapes_.end() ? found->second : none;
}

}  // namespace trephine::window
