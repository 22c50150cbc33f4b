// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_c.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <string>

#include "base/error.h"
#include "contact/contact.h"

using namespace trephine;
using namespace trephine::contact;

struct trephine_contact {
  voxel::HapticVolume volume;
  std::unique_ptr<ContactVolume> walk;
  TouchableFaces faces{0, 0};
  // The last walk, for callers that ask shape by shape.
  double start[3] = {}, end[3] = {};
  bool walked = false;
  Contact last;
};

namespace {

thread_local std::string last_error;

Vec3 vec(const double* p) { return {p[0], p[1], p[2]}; }
void put(Vec3 v, double* out) {
  if (!out) return;
  for (int a = 0; a < 3; ++a) out[a] = v[a];
}

void require(bool good, const char* what) {
  if (!good) throw Error(ExitCode::bad_input, "", "", what);
}

std::unique_ptr<trephine_contact> open_contact(const int16_t* voxels, const int32_t* size, const double* spacing_mm,
                                               const double* origin_mm, const double* direction, int32_t encoding,
                                               const trephine_shape* shapes, int32_t shape_count,
                                               const ContactParams& params) {
  require(voxels && size && spacing_mm && origin_mm, "voxels, size, spacing and origin must be given");
  require(shapes && shape_count >= 1 && shape_count <= voxel::haptic_max_shapes, "shapes must be 1 to 32");
  grid::Lattice l;
  std::int64_t count = 1;
  for (int a = 0; a < 3; ++a) {
    require(size[a] >= 1 && size[a] <= 4096, "size must be 1 to 4096");
    require(spacing_mm[a] > 0 && spacing_mm[a] < 1e6, "spacing must be positive");
    l.size[std::size_t(a)] = size[a];
    count *= size[a];
  }
  require(count <= std::int64_t{1} << 32, "voxels must be at most 2^32");
  l.spacing_mm = vec(spacing_mm);
  l.origin_mm = vec(origin_mm);
  require(is_finite(l.origin_mm), "origin must be finite");
  if (direction)
    for (int a = 0; a < 3; ++a) l.direction.column[std::size_t(a)] = vec(direction + 3 * a);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b <= a; ++b)
      require(std::abs(dot(l.direction.column[std::size_t(a)], l.direction.column[std::size_t(b)]) - (a == b)) < 1e-6,
              "direction must be orthonormal");
  auto c = std::make_unique<trephine_contact>();
  c->volume.encoding = encoding == TREPHINE_HU ? voxel::HapticEncoding::hu : voxel::HapticEncoding::occupancy;
  c->volume.voxels = grid::Grid<std::int16_t>(l);
  std::memcpy(c->volume.voxels.voxels.data(), voxels, std::size_t(count) * sizeof(*voxels));
  for (int32_t n = 0; n < shape_count; ++n) {
    const trephine_shape& s = shapes[n];
    require(s.number >= 1 && s.number <= voxel::haptic_max_shapes, "a shape's number must be 1 to 32");
    const std::string name = "shape_" + std::to_string(s.number);
    c->volume.shapes.push_back(encoding == TREPHINE_HU ? voxel::HapticShape{name, s.number, s.low, s.high}
                                                       : voxel::occupancy_shape(name, s.number));
    if (s.touchable & TREPHINE_FRONT) c->faces.front |= std::uint64_t{1} << s.number;
    if (s.touchable & TREPHINE_BACK) c->faces.back |= std::uint64_t{1} << s.number;
  }
  std::sort(c->volume.shapes.begin(), c->volume.shapes.end(),
            [](const voxel::HapticShape& a, const voxel::HapticShape& b) { return a.number < b.number; });
  voxel::check_haptic_volume(c->volume);
  c->walk = std::make_unique<ContactVolume>(c->volume, params);
  return c;
}

}  // namespace

extern "C" {

trephine_contact* trephine_contact_open(const int16_t* voxels, const int32_t size[3], const double spacing_mm[3],
                                        const double origin_mm[3], const double* direction, int32_t encoding,
                                        const trephine_shape* shapes, int32_t shape_count, int32_t walk,
                                        int32_t surface, double step_ratio) {
  try {
    last_error.clear();
    require(encoding == TREPHINE_OCCUPANCY || encoding == TREPHINE_HU, "encoding must be 0 or 1");
    require(walk == TREPHINE_EXACT || walk == TREPHINE_STEPPED, "walk must be 0 or 1");
    require(surface == TREPHINE_SUBVOXEL || surface == TREPHINE_NEAREST, "surface must be 0 or 1");
    require(walk == TREPHINE_EXACT || (step_ratio >= 0.01 && step_ratio <= 1), "step_ratio must be 0.01 to 1");
    ContactParams params;
    params.walk = walk == TREPHINE_STEPPED ? ContactParams::Walk::stepped : ContactParams::Walk::exact;
    params.surface = surface == TREPHINE_NEAREST ? ContactParams::Surface::nearest : ContactParams::Surface::subvoxel;
    params.step_ratio = walk == TREPHINE_STEPPED ? step_ratio : 1;
    return open_contact(voxels, size, spacing_mm, origin_mm, direction, encoding, shapes, shape_count, params)
        .release();
  } catch (const std::exception& e) {
    last_error = e.what();
  }
  return nullptr;
}

void trephine_contact_close(trephine_contact* contact) { delete contact; }

const char* trephine_error(void) { return last_error.c_str(); }

int32_t trephine_contact_intersect(trephine_contact* contact, const double start[3], const double end[3],
                                   double point[3], double normal[3], int32_t* face, int32_t* shape) {
  const Contact c = contact->walk->intersect(vec(start), vec(end), contact->faces);
  if (c.refused) return -1;
  if (!c.hit) return 0;
  put(c.point_mm, point);
  put(c.normal, normal);
  if (face) *face = c.face == ContactFace::front ? TREPHINE_FRONT : TREPHINE_BACK;
  if (shape) *shape = c.shape;
  return 1;
}

int32_t trephine_intersect_surface(const double start[3], const double end[3], double point[3], double normal[3],
                                   int32_t* face, void* shape_view) {
  const trephine_shape_view& view = *static_cast<const trephine_shape_view*>(shape_view);
  trephine_contact& c = *view.contact;
  const bool same =
      c.walked && std::memcmp(c.start, start, sizeof c.start) == 0 && std::memcmp(c.end, end, sizeof c.end) == 0;
  if (!same) {
    std::memcpy(c.start, start, sizeof c.start);
    std::memcpy(c.end, end, sizeof c.end);
    c.last = c.walk->intersect(vec(start), vec(end), c.faces);
    c.walked = true;
  }
  if (!c.last.hit || c.last.shape != view.shape) return 0;
  put(c.last.point_mm, point);
  put(c.last.normal, normal);
  if (face) *face = c.last.face == ContactFace::front ? TREPHINE_FRONT : TREPHINE_BACK;
  return 1;
}

}  // extern "C"
