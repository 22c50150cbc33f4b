// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/ways.h"

#include "base/error.h"

namespace trephine {
namespace {

constexpr double dot_mm = 1;  // between the dots of a way, at least
constexpr std::size_t most_dots = 500;

}  // namespace

void add_dot(std::vector<Vec3>& way, Vec3 at, double& apart_mm) {
  if (!way.empty() && norm(at - way.back()) < apart_mm) return;
  way.push_back(at);
  if (way.size() < most_dots) return;
  for (std::size_t n = 0; 2 * n < way.size(); ++n) way[n] = way[2 * n];
  way.resize((way.size() + 1) / 2);
  apart_mm *= 2;
}

std::vector<Vec3> way_of(const Recording& r) {
  std::vector<Vec3> way;
  double apart_mm = dot_mm;
  const bool lesson = !r.header.tools.empty() && !r.frames.empty();
  const int last = lesson ? belt_button::tool(r.frames.back().buttons) : 0;
  for (const ServoFrame& f : r.frames) {
    if (lesson && (belt_button::tool(f.buttons) != last || (f.touched == 0 && f.inside == 0))) continue;
    add_dot(way, {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]}, apart_mm);
  }
  return way;
}

std::vector<Vec3> way_of(const std::filesystem::path& file, const std::string& token) {
  const Recording r = read_recording(file);
  if (r.header.case_token != token)
    throw Error(ExitCode::bad_input, file.string(), "case", "is " + r.header.case_token + ", not " + token);
  return way_of(r);
}

}  // namespace trephine
