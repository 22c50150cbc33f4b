// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/ways.h"

#include "base/error.h"
#include "session/hand_watch.h"

namespace trephine::window {
namespace {

constexpr double dot_mm = 1;  // between the dots of a way, at least
constexpr std::size_t max_dots = 500;

}  // namespace

void add_dot(std::vector<Vec3>& way, Vec3 at, double& apart_mm) {
  if (!way.empty() && norm(at - way.back()) < apart_mm) return;
  way.push_back(at);
  if (way.size() < max_dots) return;
  for (std::size_t n = 0; 2 * n < way.size(); ++n) way[n] = way[2 * n];
  way.resize((way.size() + 1) / 2);
  apart_mm *= 2;
}

std::vector<Vec3> way_of(const haptics::Recording& r) {
  std::vector<Vec3> way;
  double apart_mm = dot_mm;
  const bool lesson = !r.header.tools.empty() && !r.frames.empty();
  const std::vector<std::size_t> in_hand = session::tools_in_hand(r);
  for (std::size_t n = 0; n < r.frames.size(); ++n) {
    const haptics::ServoFrame& f = r.frames[n];
    if (lesson && (in_hand[n] != in_hand.back() || (f.touched == 0 && f.inside == 0))) continue;
    add_dot(way, {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]}, apart_mm);
  }
  return way;
}

std::vector<Vec3> way_of(const std::filesystem::path& file, const std::string& token) {
  const haptics::Recording r = haptics::read_recording(file);
  if (r.header.case_token != token)
    throw Error(ExitCode::bad_input, file.string(), "case", "is " + r.header.case_token + ", not " + token);
  return way_of(r);
}

}  // namespace trephine::window
