// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/screen_registration.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/refusal.h"
#include "base/rigid_fit.h"
#include "base/write_file.h"

namespace trephine::device {
namespace {

using Json = nlohmann::ordered_json;

constexpr double far_mm = 1e4;
constexpr double min_spread_mm = 5;  // of the marks across their longest line

// How far the points lie from the line through the two that are farthest from each other.
double spread_mm(const std::vector<Vec3>& points) {
  Vec3 from, along;
  double longest = 0, most = 0;
  for (const Vec3 a : points)
    for (const Vec3 b : points)
      if (norm(b - a) > longest) longest = norm(b - a), from = a, along = normalized(b - a);
  for (const Vec3 p : points) most = std::max(most, norm(p - from - along * dot(p - from, along)));
  return most;
}

Json list_of(Vec3 v) { return {v.x, v.y, v.z}; }
Vec3 vec_of(const Json& j) { return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()}; }

}  // namespace

ScreenRegistration fit_screen(const std::vector<Vec3>& device_mm, const std::vector<Vec3>& screen_mm, bool scales) {
  if (device_mm.size() != screen_mm.size() || device_mm.size() < 3)
    throw refusal("marks", "are fewer than three", {"touch all of them with `register`"});
  if (spread_mm(device_mm) < min_spread_mm || spread_mm(screen_mm) < min_spread_mm)
    throw refusal("marks", "were touched on one line, so the screen's plane is not known",
                  {"touch those that `register` names, one after the other"});
  ScreenRegistration r;
  const RigidFit fit = fit_rigid(device_mm, screen_mm);
  r.turn = fit.map.turn;
  Vec3 from, to;
  for (std::size_t n = 0; n < device_mm.size(); ++n) {
    from += device_mm[n] / double(device_mm.size());
    to += screen_mm[n] / double(screen_mm.size());
  }
  if (scales) {
    double device_squares = 0, screen_squares = 0;
    for (const Vec3 p : device_mm) device_squares += dot(p - from, p - from);
    for (const Vec3 p : screen_mm) screen_squares += dot(p - to, p - to);
    r.scale = std::sqrt(screen_squares / device_squares);
  }
  r.offset_mm = to - r.turn * from * r.scale;
  r.marks_count = int(device_mm.size());
  double squares = 0;
  for (std::size_t n = 0; n < device_mm.size(); ++n) {
    const double off = norm(r.before_screen(device_mm[n]) - screen_mm[n]);
    squares += off * off;
    r.worst_mm = std::max(r.worst_mm, off);
  }
  r.rms_mm = std::sqrt(squares / double(device_mm.size()));
  return r;
}

std::string to_json(const ScreenRegistration& r) {
  const Json j = {{"trephine_screen", 1},
                  {"height_mm", r.height_mm},
                  {"scale", r.scale},
                  {"turn", {list_of(r.turn.column[0]), list_of(r.turn.column[1]), list_of(r.turn.column[2])}},
                  {"offset_mm", list_of(r.offset_mm)},
                  {"rms_mm", r.rms_mm},
                  {"worst_mm", r.worst_mm},
                  {"marks_count", r.marks_count}};
  return j.dump(1) + "\n";
}

ScreenRegistration read_screen_registration(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 16);
    ScreenRegistration r;
    const char* key = "trephine_screen";
    try {
      const Json j = Json::parse(bytes.begin(), bytes.end());
      if (j.at(key).get<int>() != 1) throw Error(ExitCode::bad_input, "", key, "is of another version");
      const auto number = [&](const char* name) { return j.at(key = name).get<double>(); };
      r.height_mm = number("height_mm");
      r.scale = number("scale");
      r.rms_mm = number("rms_mm");
      r.worst_mm = number("worst_mm");
      r.marks_count = j.at(key = "marks_count").get<int>();
      r.offset_mm = vec_of(j.at(key = "offset_mm"));
      const Json& turn = j.at(key = "turn");
      for (int n = 0; n < 3; ++n) r.turn.column[std::size_t(n)] = vec_of(turn.at(std::size_t(n)));
    } catch (const Json::exception&) {
      throw Error(ExitCode::bad_input, "", key, "is missing, or not what trephine-sim register writes");
    }
    const auto& c = r.turn.column;
    double off = std::abs(determinant(r.turn) - 1);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        off = std::max(off, std::abs(dot(c[std::size_t(i)], c[std::size_t(k)]) - (i == k ? 1 : 0)));
    if (!(off < 1e-6)) throw Error(ExitCode::bad_input, "", "turn", "is no rotation");
    if (!(r.scale > 0.01 && r.scale < 100)) throw Error(ExitCode::bad_input, "", "scale", "is not within 0.01 to 100");
    if (!(r.height_mm > 0 && r.height_mm < 1e5)) throw Error(ExitCode::bad_input, "", "height_mm", "is no height");
    if (!is_finite(r.offset_mm)) throw Error(ExitCode::bad_input, "", "offset_mm", "is not finite");
    return r;
  });
}

ScreenView over_screen(const ScreenView& window, const WindowPlace& place) {
  ScreenView v = window;
  v.middle_mm = window.middle_mm + (window.right * place.right + window.up * place.up) * window.height_mm;
  v.height_mm = window.height_mm * place.screen_height;
  return v;
}

ScreenDevice::ScreenDevice(std::unique_ptr<Device> device, const ScreenRegistration& registration,
                           std::shared_ptr<Mailbox<ScreenView>> view)
    : device_(std::move(device)), registration_(registration), mailbox_(std::move(view)) {}

double ScreenDevice::damping_n_s_per_mm() const {
  const double s = view_.height_mm > 0 ? scale() : registration_.scale;
  return device_->damping_n_s_per_mm() / std::min(1.0, s);  // above 1 the hand gets force_share() of the force
}

Vec3 ScreenDevice::to_case(Vec3 v) const {
  const Vec3 s = registration_.turn * v;
  return view_.right * s.x + view_.up * s.y + view_.toward * s.z;
}

Vec3 ScreenDevice::to_device(Vec3 v) const {
  return transpose_times(registration_.turn, {dot(v, view_.right), dot(v, view_.up), dot(v, view_.toward)});
}

bool ScreenDevice::read(double dt_s, DeviceReading& out) {
  if (!device_->read(dt_s, out)) return false;
  mailbox_->read(view_);
  if (!(view_.height_mm > 0)) {
    out.tip_mm = view_.middle_mm + view_.toward * far_mm;
    out.buttons = 0;
    return true;
  }
  const Vec3 at = registration_.before_screen(out.tip_mm) * (view_.height_mm / registration_.height_mm);
  out.tip_mm = view_.middle_mm + view_.right * at.x + view_.up * at.y + view_.toward * at.z;
  out.axis = to_case(out.axis);
  out.across = to_case(out.across);
  return true;
}

void ScreenDevice::send(Vec3 force_n) { device_->send(to_device(force_n) * force_share()); }

void ScreenDevice::tell(const DeviceNews& news) {
  DeviceNews own = news;
  if (view_.height_mm > 0) {
    const Vec3 off = news.proxy_mm - view_.middle_mm;
    const Vec3 screen = Vec3{dot(off, view_.right), dot(off, view_.up), dot(off, view_.toward)} *
                        (registration_.height_mm / view_.height_mm);
    own.proxy_mm = transpose_times(registration_.turn, screen - registration_.offset_mm) / registration_.scale;
  }
  own.torque_n_mm = to_device(news.torque_n_mm) * force_share();
  own.axis = to_device(news.axis);
  own.across = to_device(news.across);
  device_->tell(own);
}

}  // namespace trephine::device
