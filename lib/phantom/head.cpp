// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/head.h"

#include "base/error.h"
#include "phantom/apparatus.h"
#include "phantom/landmarks.h"

namespace trephine::phantom {
namespace {

template <class S>
Point<S> point(Vec3 p);
template <>
Point<double> point(Vec3 p) {
  return {p.x, p.y, p.z};
}
template <>
Point<Dual> point(Vec3 p) {
  return {Dual(p.x, 1, 0, 0), Dual(p.y, 0, 1, 0), Dual(p.z, 0, 0, 1)};
}

/// Newton's steps along the gradient onto the zero set; the normal there comes back too.
Vec3 onto_surface(const Model& model, Anatomy anatomy, Vec3 x, Vec3& normal) {
  for (int i = 0; i < 16; ++i) {
    const Dual f = model.solid(anatomy, point<Dual>(x));
    const Vec3 g{f.x, f.y, f.z};
    const double gg = dot(g, g);
    if (!(gg > 1e-4)) {  // on an axis or in a middle plane, where every direction is as good as the others
      x += Vec3{0.011, 0.017, 0.013};
      continue;
    }
    normal = g / std::sqrt(gg);
    if (std::fabs(f.v) < 1e-6) break;
    x += g * (-f.v / gg);
  }
  return x;
}

/// From `start` onto the surface, then along it until p - x is normal to it: a nearest point, at least locally. Where
/// the surface curves towards p a full step overshoots, and is halved.
Vec3 foot_point(const Model& model, Anatomy anatomy, Vec3 p, Vec3 start) {
  Vec3 normal;
  Vec3 x = onto_surface(model, anatomy, start, normal);
  double distance = norm(p - x), step = 1;
  for (int i = 0; i < 24; ++i) {
    const Vec3 r = p - x, along = r - normal * dot(r, normal);
    if (norm(along) < 2e-4 * (1 + distance)) break;
    bool nearer = false;
    for (; step > 0.05 && !nearer; step *= nearer ? 1 : 0.5) {
      Vec3 n = normal;
      const Vec3 y = onto_surface(model, anatomy, x + along * step, n);
      const double d = norm(p - y);
      nearer = d < distance;
      if (nearer) x = y, normal = n, distance = d;
    }
    if (!nearer) break;
    step = std::min(1.0, 1.5 * step);
  }
  return x;
}

/// Directions to the corners, edges and faces of a cube.
const std::array<Vec3, 26>& probes() {
  static const std::array<Vec3, 26> directions = [] {
    std::array<Vec3, 26> out;
    std::size_t n = 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (x || y || z) out[n++] = normalized(Vec3{double(x), double(y), double(z)});
    return out;
  }();
  return directions;
}

}  // namespace

const char* name_of(Anatomy anatomy) {
  switch (anatomy) {
    case Anatomy::skin:
      return "skin";
    case Anatomy::skull:
      return "skull";
    case Anatomy::brain:
      return "brain";
    case Anatomy::ventricles:
      return "ventricles";
  }
  return "";
}

Head::Head(const HeadParams& params) : params_(params) {
  const auto model = std::make_shared<Model>(params);
  model_ = model;
  landmarks_ = std::make_shared<const Landmarks>(find_landmarks(*this, *model));
  if (params.level == Level::hard && params.implants.implants != Implants::none)
    model->add_implants(params.implants, *landmarks_);
}

double Head::implicit_mm(Anatomy anatomy, Vec3 p) const { return model_->solid(anatomy, point<double>(p)); }

double Head::implicit_mm(Anatomy anatomy, Vec3 p, Vec3& gradient) const {
  const Dual f = model_->solid(anatomy, point<Dual>(p));
  gradient = {f.x, f.y, f.z};
  return f.v;
}

Vec3 Head::project_mm(Anatomy anatomy, Vec3 p) const {
  Vec3 best = foot_point(*model_, anatomy, p, p);
  // Is there surface nearer than the foot point found? Then the sign differs somewhere within that distance.
  const bool inside = implicit_mm(anatomy, p) < 0;
  for (int round = 0; round < 3; ++round) {
    const double distance = norm(p - best);
    if (distance < 0.2) break;
    Vec3 start = p;
    for (const Vec3& u : probes()) {
      const Vec3 q = p + u * (0.97 * distance);
      if ((implicit_mm(anatomy, q) < 0) != inside) {
        start = q;
        break;
      }
    }
    if (start == p) break;
    const Vec3 other = foot_point(*model_, anatomy, p, start);
    if (!(norm(p - other) < distance)) break;
    best = other;
  }
  return best;
}

double Head::signed_distance_mm(Anatomy anatomy, Vec3 p) const {
  const double d = norm(p - project_mm(anatomy, p));
  return implicit_mm(anatomy, p) < 0 ? -d : d;
}

std::uint8_t Head::label(Vec3 lps) const {
  const auto base = model_->base(point<double>(lps), true);
  const bool hard = model_->hard.on;
  if (model_->skin(base) >= 0) return hard && apparatus_at(*model_, lps, 1e-6).thing != Thing::none ? 7 : 0;
  if (skull_of(*model_, base) < 0) return 2;
  if (hard && model_->vertebrae(base) < 0) return 6;
  if (base.cavity >= 0) return 1;
  if (model_->ventricles(base.p) < 0) return 4;
  if (model_->brain_clipped(base) < 0) return 3;
  return base.p.z > foramen_magnum_z ? 5 : 1;
}

Thing Head::thing(Vec3 lps) const {
  const Model::Hard& hard = model_->hard;
  if (!hard.on) return Thing::none;
  const auto base = model_->base(point<double>(lps), true);
  const double skin = model_->skin(base);
  if (skin >= 0) return apparatus_at(*model_, lps, 1e-6).thing;
  const auto in_ball = [&](const Model::Ball& b) { return sphere(base.p, b.centre, b.radius) < 0; };
  const auto in_tube = [&](const Model::Tube& t) {
    return capsule(base.p, t.from, t.to, t.radius_from, t.radius_to) < 0;
  };
  for (const Vec3& f : model_->fillings)
    if (in_ball({f, 2.6})) return Thing::metal;
  if (std::any_of(hard.metal.begin(), hard.metal.end(), in_ball)) return Thing::metal;
  if (std::any_of(hard.catheter.begin(), hard.catheter.end(), in_tube)) return Thing::catheter;
  if (base.cavity < 0) {
    const double hu = sample(lps, 1e-6).hu;
    if (std::any_of(hard.calcified.begin(), hard.calcified.end(), in_ball)) return Thing::calcification;
    if (hard.is.contrast && model_->vessels(base) < 0 && base.cavity + 0.4 < 0) return Thing::vessel;
    return hard.is.blood != Blood::none && hu > 60 && hu < 72 ? Thing::blood : Thing::none;
  }
  const double bone = smooth_intersection(base.hull, -base.cavity, 1.5);
  return bone < 0 && model_->defects(base) < 0 ? Thing::bone_defect : Thing::none;
}

std::vector<std::pair<std::string, Vec3>> Head::things_mm() const {
  const Model::Hard& hard = model_->hard;
  std::vector<std::pair<std::string, Vec3>> out;
  if (!hard.on) return out;
  // A hole reaches 16 mm inwards and 25 mm outwards from the bone's outside.
  for (const Model::Tube& t : hard.holes)
    out.emplace_back("burr_hole", model_->to_world(t.from + (t.to - t.from) * (16.0 / 41)));
  if (hard.is.craniectomy) out.emplace_back("craniectomy", model_->to_world(hard.flap_centre));
  if (hard.is.shunt) out.emplace_back("shunt_tip", model_->to_world(hard.catheter.front().from));
  if (hard.is.blood == Blood::intracerebral) out.emplace_back("blood", model_->to_world(hard.bleed_centre));
  if (hard.is.blood == Blood::subdural) out.emplace_back("blood", model_->to_world(hard.subdural_centre));
  for (const ImplantTruth& t : model_->implants)
    if (t.has_catheter) out.emplace_back("catheter_tip", t.tip_mm);
  for (const Model::Ball& b : hard.metal) out.emplace_back("metal", model_->to_world(b.centre));
  return out;
}

const std::vector<ImplantTruth>& Head::implants() const { return model_->implants; }

double Head::label_clearance_mm(Vec3 p) const {
  const double plane = std::fabs(model_->to_model(point<double>(p)).z - foramen_magnum_z);
  return std::min(sample(p, 1e-6).clearance_mm, 0.8 * plane);
}

Vec3 Head::landmark(const std::string& name) const {
  for (const auto& l : *landmarks_)
    if (l.first == name) return l.second;
  throw Error(ExitCode::internal, "", name, "is no landmark of the phantom");
}

const std::vector<Vec3>& Head::metal_mm() const { return model_->metal_world; }

}  // namespace trephine::phantom
