// SPDX-License-Identifier: GPL-3.0-or-later
// What level hard changes in the head's shapes, and where its things lie.
#include <algorithm>
#include <functional>

#include "base/pi.h"
#include "phantom/apparatus.h"
#include "phantom/random.h"

namespace trephine::phantom {
namespace {

constexpr std::uint64_t hard_stream = 30;  // draws of their own, so that the individual stays the same

/// The point of the ray from `from` outwards where f is first above `level`, by steps and bisection.
template <class F>
Vec3 march(Vec3 from, Vec3 direction, double level, F&& f) {
  const Vec3 u = normalized(direction);
  double low = 0, high = 0;
  while (high < 400 && f(from + u * high) < level) low = high, high += 1;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (f(from + u * middle) < level ? low : high) = middle;
  }
  return from + u * high;
}

/// A capsule whose radius is scaled; the segment's own foot point as in capsule().
template <class S>
S scaled_capsule(const Point<S>& p, const Model::Node& a, const Model::Node& b, const S& ratio) {
  const Point<S> q = p - a.at;
  const Vec3 d = b.at - a.at;
  const S t = clamped(S((q.x * S(d.x) + q.y * S(d.y) + q.z * S(d.z)) * S(1 / dot(d, d))), 0, 1);
  const S x = q.x - t * S(d.x), y = q.y - t * S(d.y), z = q.z - t * S(d.z);
  return root(x * x + y * y + z * z + S(1e-12)) - (S(a.radius) + t * S(b.radius - a.radius)) * ratio;
}

constexpr double subdural_reach_mm = 62, subdural_thick_mm = 8;  // of the usual one, thinner towards its rim

/// Gives the blood the volume that is asked for.
void size_blood(Model& model) {
  Model::Hard& hard = model.hard;
  const double ml = hard.is.blood_ml / (model.scale.x * model.scale.y * model.scale.z);
  const Vec3 r = hard.bleed_radii;
  hard.bleed_radii = r * std::cbrt(ml * 1000 / (4.0 / 3 * pi * r.x * r.y * r.z));
  // A cap whose thickness falls with the square of the distance has half the volume of a disc.
  const double usual_ml = 0.5 * pi * subdural_reach_mm * subdural_reach_mm * subdural_thick_mm / 1000;
  hard.subdural_scale = std::cbrt(ml / usual_ml);
  if (hard.is.blood != Blood::intraventricular) return;
  constexpr double step_mm = 1;
  std::vector<double> y;
  for (double z = 0; z < 110; z += step_mm)
    for (double x = -60; x < 60; x += step_mm)
      for (double at = -70; at < 80; at += step_mm)
        if (model.ventricles(PointD{x, at, z}) < 0) y.push_back(at);
  const std::size_t n = std::min(y.size(), std::size_t(ml * 1000 / (step_mm * step_mm * step_mm)));
  std::sort(y.begin(), y.end(), std::greater<>());
  if (n > 0) hard.settled_y = y[n - 1];
}

}  // namespace

void Model::make_hard(const HeadParams& params) {
  const std::uint64_t seed = static_cast<std::uint64_t>(params.seed);
  std::uint64_t draws = 0;
  const auto draw = [&](double mean, double half) { return mean + half * uniform(seed, hard_stream, draws++); };
  hard.on = true;
  const HardParams& is = hard.is = params.hard;
  const auto hull_at = [&](Vec3 p) {
    const PointD m{std::sqrt(p.x * p.x + 2.25), p.y, p.z};
    return bone_hull(m, cranial_vault(m));
  };
  hard.thin_side = draw(0, 1) < 0 ? -1 : 1;
  const double angle = draw(0, pi);
  hard.moves = is.motion_mm > 0;
  hard.motion_mm = {is.motion_mm * std::cos(angle), is.motion_mm * std::sin(angle), 0};

  // Kocher's place on the right, give or take; the hole points at the frontal horn.
  const Vec3 aim{-draw(9, 2), draw(-27, 3), 60};
  const Vec3 through = march(aim, {draw(-24, 4), draw(-16, 5), 60}, 0, hull_at);
  const Vec3 out = normalized(through - aim);
  if (is.burr_hole || is.shunt)
    hard.holes.push_back({through - out * 16, through + out * 25, is.burr_hole ? 7.0 : 6.0, is.burr_hole ? 7.0 : 6.0});
  hard.flap_centre = {draw(62, 2), draw(-8, 8), draw(78, 5)};
  hard.flap_radii = {30, draw(45, 4), draw(36, 4)};
  hard.subdural_centre = {draw(0, 1) < 0 ? -50.0 : 50.0, draw(-10, 10), 88};
  hard.bleed_centre = {draw(0, 1) < 0 ? -34.0 : 34.0, draw(0, 14), draw(74, 6)};
  hard.bleed_radii = {draw(13, 3), draw(18, 4), draw(13, 3)};
  hard.settled_y = lateral[5].at.y + 2;  // it settles in the occipital horns
  if (is.blood_ml > 0) size_blood(*this);

  if (is.shunt) {
    // From the frontal horn along the hole's axis, then under the scalp to a valve above the right ear.
    const Vec3 tip{-lateral[1].at.x, lateral[1].at.y + 6, lateral[1].at.z};
    const auto under_scalp = [&](Vec3 direction) { return march({0, -5, 55}, direction, 2.2, hull_at); };
    std::vector<Vec3> course{tip, through + out * 2.2};
    const Vec3 start = course.back() - Vec3{0, -5, 55}, valve{-60, 38, 6};
    for (int i = 1; i <= 10; ++i) course.push_back(under_scalp(start * (1 - 0.1 * i) + valve * (0.1 * i)));
    for (std::size_t i = 0; i + 1 < course.size(); ++i) hard.catheter.push_back({course[i], course[i + 1], 1.25, 1.25});
    Tube &before = hard.catheter[hard.catheter.size() - 2], &last = hard.catheter.back();  // the valve is between them
    before = {before.from, before.to, before.radius_from, 3.2};
    last = {last.from, last.to, 3.2, last.radius_to};
    hard.metal.push_back({course[course.size() - 2], 1.2});
  }
  if (is.plexus) {
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i < 3; ++i)
        hard.calcified.push_back({Vec3{side * lateral[5].at.x, lateral[5].at.y, lateral[5].at.z} +
                                      Vec3{draw(0, 0.8), draw(0, 2.5), draw(0, 1.5)},
                                  std::min(0.45 * lateral[5].radius, draw(2.2, 0.7))});
    hard.calcified.push_back({{0.3, third_centre.y + 21, third_centre.z + 3}, draw(2.3, 0.7)});
    for (int i = 0; i < 4; ++i) hard.calcified.push_back({{0, -58 + 7.0 * i, draw(96, 4)}, draw(1.3, 0.4)});
  }
  if (is.contrast)
    hard.vessels = {{{13, -16, 2}, {14, -17, 20}, 2.2, 2.0},   {{14, -17, 20}, {40, -22, 25}, 1.6, 1.2},
                    {{14, -17, 20}, {1.5, -26, 24}, 1.3, 1.2}, {{1.5, -26, 24}, {1.5, -50, 52}, 1.2, 1.1},
                    {{0, -8, -16}, {0, -12, 16}, 1.8, 1.6},    {{0, -12, 16}, {16, 8, 22}, 1.3, 1.0},
                    {{0, 36, 42}, {0, 70, 27}, 2.2, 3.0},      {{0, 70, 26}, {44, 44, 12}, 3.6, 3.4},
                    {{44, 44, 12}, {38, 26, -4}, 3.4, 3.4},    {{0, -60, 104}, {0, -20, 115.5}, 1.8, 2.4},
                    {{0, -20, 115.5}, {0, 22, 111}, 2.4, 2.8}, {{0, 22, 111}, {0, 54, 95}, 2.8, 3.2},
                    {{0, 54, 95}, {0, 74, 66}, 3.2, 3.4},      {{0, 74, 66}, {0, 70, 26}, 3.4, 3.8}};
  for (int i = static_cast<int>(fillings.size()); i < is.fillings_count; ++i) {
    const double x = 20 + 4.2 * (i / 2);
    fillings.push_back({i % 2 ? x : -x, -92 + 0.036 * x * x + 2, i % 3 ? -47.0 : -53.0});
  }
  fillings.resize(static_cast<std::size_t>(is.fillings_count));
  if (is.clip) hard.metal.push_back({{15, -19, 19}, 1.7});

  // The couch lies 9 mm behind the head, and the mask has its markers at both sides and in front.
  const auto skin_at = [&](Vec3 p) { return skin(base(PointD{p.x, p.y, p.z}, true)); };
  double back = 0;
  for (double z = -20; z <= 60; z += 4) back = std::max(back, march({0, 20, z}, {0, 1, 0}, 0, skin_at).y);
  hard.couch_mm = back + 9;
  for (const Vec3 way : {Vec3{1, -0.06, 0}, Vec3{-1, -0.06, 0}, Vec3{0.02, -1, 0.1}})
    hard.markers.push_back({march({0, 0, 30}, way, 2.5, [&](Vec3 p) { return mask_envelope(*this, p); }), 1.0});
}

template <class S>
S Model::defects(const Base<S>& b) const {
  S f(1e3);
  for (const Tube& t : hard.holes) f = t.lesser_of(f, b.p);
  if (hard.is.craniectomy) f = lesser(f, ellipsoid(b.p, hard.flap_centre, hard.flap_radii));
  return f;
}

template <class S>
S Model::vertebrae(const Base<S>& b) const {
  // A column around the canal, 18 mm from one to the next: a body in front, an arch around, a spine behind.
  const Point<S>& p = b.p;
  const S below = p.z + S(37.0);  // the first lies under the foramen magnum
  if (value(below) > 4) return below;
  const S canal = capsule(p, {0, 26, -12}, {0, 30, -260}, 14.5, 9.5);
  const double turn = 18 * std::round((value(p.z) + 46) / 18);
  const S along = magnitude(p.z + S(46.0) - S(turn));
  const S body = smooth_intersection(capsule(p, {0, 3, -50}, {0, 10, -270}, 10.5, 12), along - S(6.3), 2.0);
  S arch = smooth_intersection(canal - S(4.2), along - S(5.0), 2.0);
  arch = smooth_union(arch, smooth_intersection(capsule(p, {0, 40, -60}, {0, 58, -280}, 4, 5), along - S(3.5), 2.0), 3);
  const Point<S> m{magnitude(p.x), p.y, p.z};
  arch = smooth_union(arch, smooth_intersection(capsule(m, {21, 18, -40}, {22, 22, -270}, 6.5, 7), along - S(5.0), 2.0),
                      3);
  return greater(smooth_intersection(smooth_union(body, arch, 3), -canal, 1.0), below);
}

template <class S>
S Model::hard_skin(const Base<S>& b, S f) const {
  if (hard.is.shoulders && value(b.p.z) < -80) {
    const S s = capsule(b.m, {0, 42, -172}, {165, 50, -206}, 60, 48);
    f = smooth_union(f, S(smooth_union(s, capsule(b.m, {0, 40, -176}, {60, 44, -420}, 66, 110), 30)), 34);
  }
  for (const Tube& t : hard.holes) {
    const S in = clamped(S(S(1.0) - capsule(b.p, t.from, t.to, 0.0, 0.0) * S(1 / 12.0)), 0, 1);
    f = f + in * in * S(1.8);
  }
  if (hard.is.craniectomy) {
    const S in = clamped(S(ellipsoid(b.p, hard.flap_centre, hard.flap_radii) * S(-1 / 14.0)), 0, 1);
    f = f + in * in * (S(3.0) - S(2.0) * in) * S(3.5);
  }
  return f;
}

template <class S>
S Model::subdural_mm(const Base<S>& b) const {
  if (hard.is.blood != Blood::subdural) return S(0.0);
  const Point<S> q = b.p - hard.subdural_centre;
  const double reach_mm = subdural_reach_mm * hard.subdural_scale;
  const S in = clamped(S(S(1.0) - (q.x * q.x + q.y * q.y + q.z * q.z) * S(1 / (reach_mm * reach_mm))), 0, 1);
  return in * S(subdural_thick_mm * hard.subdural_scale);
}

template <class S>
S Model::vessels(const Base<S>& b) const {
  S f(1e3);
  const Point<S> m{magnitude(b.p.x), b.p.y, b.p.z};
  for (const Tube& t : hard.vessels) f = t.lesser_of(f, m);
  return f;
}

template <class S>
S Model::uneven_ventricles(const Point<S>& p, const Point<S>& m) const {
  // The ratio goes from one side to the other within the septum's 12 mm, so that the functions stay smooth.
  const S ratio = S(1.0) - S(hard.is.asymmetry_ratio) * clamped(S(S(0.5) + p.x * S(hard.thin_side / 12)), 0, 1);
  S f(1e3);
  for (std::size_t i = 0; i + 1 < lateral.size(); ++i)
    f = smooth_union(f, scaled_capsule(m, lateral[i], lateral[i + 1], ratio), 2.0);
  for (std::size_t i = 0; i + 1 < temporal_horn.size(); ++i)
    f = smooth_union(f, scaled_capsule(m, temporal_horn[i], temporal_horn[i + 1], ratio), 2.0);
  return smooth_union(f, capsule(m, monro_top.at, monro_bottom.at, monro_top.radius, monro_bottom.radius), 1.2);
}

#define TREPHINE_INSTANTIATE(S)                                \
  template S Model::defects(const Model::Base<S>&) const;      \
  template S Model::vertebrae(const Model::Base<S>&) const;    \
  template S Model::hard_skin(const Model::Base<S>&, S) const; \
  template S Model::subdural_mm(const Model::Base<S>&) const;  \
  template S Model::vessels(const Model::Base<S>&) const;      \
  template S Model::uneven_ventricles(const Point<S>&, const Point<S>&) const;
TREPHINE_INSTANTIATE(double)
TREPHINE_INSTANTIATE(Dual)
#undef TREPHINE_INSTANTIATE

}  // namespace trephine::phantom
