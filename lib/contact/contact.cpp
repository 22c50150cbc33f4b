// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact.h"

#include "contact/contact_normal.h"
#include "contact/contact_samples.h"
#include "contact/crossing.h"

namespace trephine::contact {

ContactVolume::ContactVolume(voxel::HapticVolume& volume, ContactParams params)
    : felt_(std::make_unique<FeltLattice>(volume, params)) {}
ContactVolume::~ContactVolume() = default;

const voxel::HapticVolume& ContactVolume::volume() const { return felt_->volume; }
const ContactParams& ContactVolume::params() const { return felt_->params; }
double ContactVolume::smallest_side_mm() const { return felt_->smallest_side_mm; }

void ContactVolume::loosen(const grid::Box& box) {
  felt_->clear.loosen(box);
  felt_->blocks.loosen(box);
}
void ContactVolume::settle(const grid::Box& box) { felt_->blocks.settle(box); }
std::uint32_t ContactVolume::loosened() const { return felt_->blocks.loosened(); }

int ContactVolume::shape_at(Vec3 world_mm) const {
  return detail::usable(world_mm) ? felt_->shape_of(felt_->to_index(world_mm)) : 0;
}

void ContactVolume::clear_mm(Vec3 tip_mm, const Mat3& frame, const std::vector<Vec3>& points_mm,
                             const std::vector<std::uint8_t>& shapes, std::vector<double>& out) const {
  const Vec3 tip = felt_->to_index(tip_mm);
  Mat3 turn;
  for (std::size_t a = 0; a < 3; ++a) turn.column[a] = felt_->index_of_world * frame.column[a];
  for (std::size_t n = 0; n < points_mm.size(); ++n)
    out[n] = felt_->clear.clear_mm(tip + turn * points_mm[n], shapes[n]);
}

double ContactVolume::clear_beside_mm(Vec3 world_mm, int shape) const {
  return detail::usable(world_mm) ? clear_of_cells(*felt_, felt_->to_index(world_mm), shape) : 0;
}

Contact ContactVolume::intersect(Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces) const {
  Contact out = cross(start_mm, end_mm, start_shape, faces);
  if (out.hit) out.normal = normal_of(out, end_mm - start_mm);
  return out;
}

Contact ContactVolume::cross(Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces,
                             ContactBox* known) const {
  return cross_segment(*felt_, start_mm, end_mm, start_shape, faces, known);
}

Vec3 ContactVolume::normal_of(const Contact& contact, Vec3 way) const {
  return trephine::contact::normal_of(*felt_, contact, way);
}

Vec3 ContactVolume::normal_at(Vec3 world_mm, int from, int into) const {
  return fitted_normal(*felt_, world_mm, from, into);
}

Vec3 ContactVolume::exact_normal(const Contact& contact, Vec3 way) const {
  return trephine::contact::exact_normal(*felt_, contact, way);
}

int ContactVolume::samples_near(Vec3 from_mm, Vec3 to_mm, double reach_mm, SurfaceSample* out, int most,
                                KnownSamples* known) const {
  return trephine::contact::samples_near(*felt_, from_mm, to_mm, reach_mm, out, most, known);
}

}  // namespace trephine::contact
