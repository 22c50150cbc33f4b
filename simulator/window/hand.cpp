// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/hand.h"

#include <algorithm>
#include <cmath>

#include "surface/bounds.h"

namespace trephine::window {
namespace {

constexpr double begin_mm = 15;                 // before the site, where the tool waits
constexpr double before_field_mm = 40;          // before and beside a lesson's field that is open
constexpr double above_surface_mm = 2;          // where a tool is put that goes to a surface
constexpr double max_mm = 1e5, ahead_mm = 8;    // from the middle; of the tool that is held back
constexpr double press_mm = 1.5, near_mm = 20;  // how deep a marker is pressed to draw; within which it is led there

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

Hand::Hand(CaseView& view, const std::string& site, bool behind) : view_(view) {
  const surface::Bounds& b = view.stage().scene().bounds;
  goal_.tip_mm = {(b.min_mm.x + b.max_mm.x) / 2, (b.min_mm.y + b.max_mm.y) / 2, b.max_mm.z + begin_mm};
  if (behind) {
    goal_.axis = {0, 1, 0};
    goal_.tip_mm = {(b.min_mm.x + b.max_mm.x) / 2, b.max_mm.y + begin_mm, (b.min_mm.z + b.max_mm.z) / 2};
  }
  const bool stands = view.stands_from && dot(view.camera.toward, *view.stands_from) > 0.99;
  if (stands && !behind) {  // a surgeon's view without a C-arm: held from below, outside of all
    const Vec3 at = view.open_field_mm ? *view.open_field_mm : view.middle_mm();
    const Vec3 toward = view.camera.toward, up = view.camera.up;
    double out_mm = 0;
    for (const Vec3 corner : surface::corners_of(b)) out_mm = std::max(out_mm, dot(corner - at, toward));
    goal_.axis = normalized(toward - up);
    goal_.tip_mm = at + toward * (out_mm + begin_mm) - up * before_field_mm;
  } else if (view.open_field_mm) {
    goal_.axis = normalized(*view.open_field_mm - view.middle_mm());
    goal_.tip_mm = *view.open_field_mm + (goal_.axis + view.camera.right()) * before_field_mm;
  }
  if (const auto a = scene::approach_of(view.manifest(), view.stage().scene(), site)) {
    goal_.axis = -a->direction;
    goal_.tip_mm = a->site_mm + goal_.axis * begin_mm;
  }
}

void Hand::aim() {
  if (screen_) screen_->aim(goal_);
}

void Hand::move(Vec3 by_mm) {
  const Vec3 next = goal_.tip_mm + by_mm;
  if (!is_finite(next) || norm(next) > max_mm) return;
  goal_.tip_mm = next;
  aim();
}

void Hand::move_in_picture(double right_mm, double up_mm, const Cursor& picture, bool draws) {
  const scene::OrbitCamera& camera = view_.camera;
  const Vec3 by = camera.right() * right_mm + camera.up * up_mm;
  if (!draws) return move(by);
  Cursor at = picture;
  const Vec3 seen = view_.eye(picture).project(goal_.tip_mm + by, picture.width, picture.height);
  at.x = seen.x;
  at.y = seen.y;
  draw_at(at);
}

void Hand::advance(double mm) {
  const Vec3 ahead = -normalized(vec(view_.frame().axis));
  const double behind = dot(goal_.tip_mm - vec(view_.frame().tip_mm), ahead);
  if (mm > 0 ? behind < ahead_mm : behind > -ahead_mm) move(ahead * mm);
}

void Hand::place(Vec3 tip_mm, const std::optional<Vec3>& axis) {
  if (!is_finite(tip_mm) || !(norm(tip_mm) <= max_mm)) return;
  goal_.tip_mm = tip_mm;
  if (axis && is_finite(*axis) && norm(*axis) > 1e-3) goal_.axis = normalized(*axis);
  ++goal_.lifts;
  aim();
}

void Hand::turn(double right_rad, double up_rad) {
  const scene::OrbitCamera& camera = view_.camera;
  const Vec3 axis = goal_.axis + camera.right() * std::tan(right_rad) + camera.up * std::tan(up_rad);
  if (norm(axis) > 1e-3) goal_.axis = normalized(axis);
  aim();
}

void Hand::aim_at_viewer() {
  goal_.axis = view_.camera.toward;
  aim();
}

texts::Answer Hand::aim_at_target() {
  const cases::CaseTarget* target = view_.nearest_target(goal_.tip_mm);
  if (!target) return texts::NoteId::no_target;
  if (norm(goal_.tip_mm - target->position_mm) > 1) goal_.axis = normalized(goal_.tip_mm - target->position_mm);
  aim();
  return {};
}

texts::Answer Hand::to_surface(const Cursor& cursor) {
  const contact::Contact c = view_.seen(cursor);
  if (!c.hit) return texts::NoteId::nothing_there;
  const Vec3 normal = norm(c.normal) > 0 ? normalized(c.normal) : view_.camera.toward;
  place(c.point_mm + normal * above_surface_mm, normal);
  return {};
}

void Hand::draw_at(const Cursor& cursor) {
  const contact::Contact c = view_.seen(cursor);
  if (!c.hit) return;
  const Vec3 normal = norm(c.normal) > 0 ? normalized(c.normal) : view_.camera.toward;
  if (norm(c.point_mm - vec(view_.frame().tip_mm)) > near_mm) {
    place(c.point_mm + normal * press_mm, normal);
    return;
  }
  goal_.tip_mm = c.point_mm - normal * press_mm;
  goal_.axis = normal;
  aim();
}

void Hand::press(std::uint32_t button, bool down) {
  goal_.buttons = down ? goal_.buttons | button : goal_.buttons & ~button;
  aim();
}

void Hand::pull_at_least(double max_n) {
  goal_.min_most_n = max_n;
  aim();
}

}  // namespace trephine::window
