// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/print_registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/rank.h"
#include "base/refusal.h"
#include "base/symmetric_eigen.h"
#include "track/inliers.h"

namespace trephine::track {
namespace {

constexpr std::size_t least_touches = 10;
constexpr int rounds = 30;
constexpr double least_scale_mm = 0.05, least_spread_ratio = 0.04;
constexpr double scale_off = 0.02;  // of the tracker's mm

// Where the sums of squares of |p|^2 - 2 c p - k are least: near the middle, whatever the radius.
Vec3 rough_middle(const std::vector<Vec3>& places) {
  Vec3 mean;
  for (const Vec3 p : places) mean += p / double(places.size());
  SquareMatrix<3> spread{};
  Vec3 against;
  double square = 0;
  for (const Vec3 p : places) square += dot(p - mean, p - mean) / double(places.size());
  for (const Vec3 p : places) {
    const Vec3 d = p - mean;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) spread[std::size_t(i)][std::size_t(k)] += 2 * d[i] * d[k];
    against += d * (dot(d, d) - square);
  }
  Vec3 out = mean;
  for (const EigenPair<3>& a : symmetric_eigen<3>(spread)) {
    const Vec3 v{a.vector[0], a.vector[1], a.vector[2]};
    if (a.value > 1e-9) out += v * (dot(v, against) / a.value);
  }
  return out;
}

// Without what cannot be of one sphere with the most of them, such as places on the way to it.
std::vector<Vec3> together(const std::vector<Vec3>& places, double radius) {
  constexpr double slack_mm = 4;
  Vec3 median;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> sorted;
    sorted.reserve(places.size());
    for (const Vec3 p : places) sorted.push_back(p[a]);
    median[a] = median_of(sorted);
  }
  std::vector<Vec3> kept;
  for (const Vec3 p : places)
    if (norm(p - median) < 2 * radius + slack_mm) kept.push_back(p);
  return kept;
}

std::vector<double> off_of(const std::vector<Vec3>& places, Vec3 middle, double radius) {
  std::vector<double> off;
  off.reserve(places.size());
  for (const Vec3 p : places) off.push_back(std::abs(norm(p - middle) - radius));
  return off;
}

// One step of Gauss and Newton; the spread of the directions in which the places lie.
double step(const std::vector<Vec3>& places, double radius, Vec3& middle) {
  SquareMatrix<3> normal{};
  Vec3 against;
  for (const Vec3 p : places) {
    const Vec3 way = normalized(p - middle);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) normal[std::size_t(i)][std::size_t(k)] += way[i] * way[k];
    against += way * (norm(p - middle) - radius);
  }
  const auto axes = symmetric_eigen<3>(normal);
  for (const EigenPair<3>& a : axes) {
    const Vec3 v{a.vector[0], a.vector[1], a.vector[2]};
    if (a.value > 1e-9) middle += v * (dot(v, against) / a.value);
  }
  return axes[0].value / double(places.size());
}

// Of all distances between what was found to those of the marks: 1 where a mm of the tracker is one.
double scale_of(const std::vector<Vec3>& found, const std::vector<lesson::PrintMark>& marks) {
  double here = 0, there = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t k = i + 1; k < found.size(); ++k) {
      here += norm(found[i] - found[k]);
      there += norm(marks[i].case_mm - marks[k].case_mm);
    }
  return there > 0 ? here / there : 1;
}

// Names of parameters stand in backticks, as a test reads them.
const Remedy touch_again{
    "touch the marks again, with the tip on the sphere and not on its post; `marks` names those that are whole"};

}  // namespace

std::optional<TouchedSphere> touched_sphere(const std::vector<Vec3>& all, double radius) {
  const std::vector<Vec3> places = together(all, radius);
  if (places.size() < least_touches) return {};
  std::vector<Vec3> used = places;
  TouchedSphere s;
  s.middle_mm = rough_middle(places);
  for (int round = 0; round < rounds; ++round) {
    s.spread_ratio = step(used, radius, s.middle_mm);
    if (!is_finite(s.middle_mm)) return {};
    if (round >= 3) used = inliers(places, off_of(places, s.middle_mm, radius), least_scale_mm);
    if (used.size() < least_touches) return {};
  }
  double squares = 0;
  for (const double off : off_of(used, s.middle_mm, radius)) squares += off * off / double(used.size());
  s.residual_mm = std::sqrt(squares);
  s.used = used.size();
  return s;
}

Vec3 mark_middle(const std::vector<Vec3>& tips, double radius, int number, const MarkParams& params) {
  const auto refuse = [&](const std::string& what) {
    throw refusal("marks", fmt::format("mark {}: {}", number, what),
                  {"slide the tip over all of the sphere that can be reached without lifting it, or leave that one out "
                   "of `marks`"});
  };
  const std::optional<TouchedSphere> s = touched_sphere(tips, radius + 0.5 * params.tip_ball_mm);
  if (!s) refuse("the touched places say nothing of a sphere");
  if (s->spread_ratio < least_spread_ratio) refuse("only a small part of the sphere was touched");
  if (2 * s->used < tips.size() || s->residual_mm > params.largest_touch_mm)
    refuse(
        fmt::format("the touched places lie {:.2f} mm off a sphere of {:g} mm, at most {:g} (largest_touch_mm) are "
                    "allowed; {} of {} were left out",
                    s->residual_mm, 2 * radius, params.largest_touch_mm, tips.size() - s->used, tips.size()));
  return s->middle_mm;
}

PrintPlace place_print(const lesson::PrintRecord& print, const std::vector<std::size_t>& asked,
                       const std::vector<Vec3>& middles, const MarkParams& params) {
  PrintPlace place;
  const double most = 2 * params.largest_marks_mm;
  place.fit = lesson::match_marks(print.marks, middles, {most, most});
  const lesson::MarkFit& fit = place.fit;
  if (fit.mirrored_marks > fit.marks || (fit.mirrored_marks >= lesson::least_marks && fit.mirrored_marks == fit.marks &&
                                         fit.residual_mm > fit.mirrored_residual_mm))
    throw refusal("marks", "their mirror image fits: the tracker's frame is left-handed, or another print was touched",
                  {"set the server to a right-handed frame, or give the print that lies there; `marks` names those "
                   "that are touched"});
  if (fit.marks < lesson::least_marks) {
    std::vector<lesson::PrintMark> touched;
    for (const std::size_t n : asked) touched.push_back(print.marks[n]);
    if (const double scale = scale_of(middles, touched); std::abs(scale - 1) > scale_off)
      throw refusal("marks", fmt::format("they lie {:.3g} times as far apart as in the print", scale),
                    {"set the server to mm, or print at the size of the file (`trephine export`)"});
    throw refusal("marks",
                  fmt::format("{} of {} that were touched lie as the print's do, at least {} are needed", fit.marks,
                              middles.size(), lesson::least_marks),
                  touch_again);
  }
  // Four of many fit the marks of another head, too.
  if (4 * (middles.size() - fit.marks) > middles.size())
    throw refusal(
        "marks",
        fmt::format("{} of {} that were touched do not lie as the print's do, at most a quarter may be left out",
                    middles.size() - fit.marks, middles.size()),
        touch_again);
  if (fit.residual_mm > params.largest_marks_mm)
    throw refusal("marks",
                  fmt::format("they lie {:.2f} mm off, at most {:g} (largest_marks_mm) are allowed", fit.residual_mm,
                              params.largest_marks_mm),
                  touch_again);
  place.reference_to_case = inverse(fit.map);
  for (std::size_t n = 0; n < fit.used_mm.size(); ++n)
    if (print.marks[asked[fit.places[n]]].case_mm != fit.used_mm[n]) place.exchanged.push_back(fit.places[n]);
  for (const lesson::PrintTarget& t : print.targets) place.targets.push_back({t.name, fit.error_mm(t.case_mm), 0});
  const double n = double(fit.used_mm.size());
  for (std::size_t out = 0; out < fit.used_mm.size(); ++out) {
    std::vector<Vec3> from = fit.used_mm, to = fit.found_mm;
    from.erase(from.begin() + std::ptrdiff_t(out)), to.erase(to.begin() + std::ptrdiff_t(out));
    const RigidMap other = fit_rigid(from, to).map;
    const Vec3 off = other(fit.used_mm[out]) - fit.found_mm[out];
    place.left_out_mm += dot(off, off) / n;
    for (std::size_t k = 0; k < print.targets.size(); ++k) {
      const Vec3 moved = other(print.targets[k].case_mm) - fit.map(print.targets[k].case_mm);
      place.targets[k].left_out_mm += dot(moved, moved) * (n - 1) / n;
    }
  }
  place.left_out_mm = std::sqrt(place.left_out_mm);
  for (TrackedTarget& t : place.targets) {
    t.left_out_mm = std::sqrt(t.left_out_mm);
    place.target_error_mm = std::max({place.target_error_mm, t.error_mm, t.left_out_mm});
  }
  if (print.targets.empty()) place.target_error_mm = place.left_out_mm;
  if (place.target_error_mm > params.largest_target_mm)
    throw refusal("marks",
                  fmt::format("the expected error where the procedure aims is {:.2f} mm, at most {:g} "
                              "(largest_target_mm) are allowed",
                              place.target_error_mm, params.largest_target_mm),
                  {"touch more `marks`, all around the head"});
  return place;
}

double check_off_mm(const lesson::PrintRecord& print, Vec3 tip, double tip_ball_mm) {
  double off = 1e9;
  for (const lesson::PrintMark& m : print.marks)
    off = std::min(off, std::abs(norm(tip - m.case_mm) - 0.5 * (m.diameter_mm + tip_ball_mm)));
  return off;
}

}  // namespace trephine::track
