// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/felt_space.h"

namespace trephine::touch {

contact::Contact FeltSpace::nearer(const contact::Contact& felt, Vec3 start, int start_shape,
                                   const contact::TouchableFaces& faces) const {
  if (felt.refused) return felt;
  const MeshSurfaces::Meeting met = beside_.meshes->first_met(start, felt.point_mm, faces.front);
  if (met.shape == 0) return felt;
  contact::Contact c;
  c.hit = true;
  c.along = felt.hit ? met.along * felt.along : met.along;
  c.point_mm = met.point_mm;
  c.normal = met.normal;
  c.face = met.front ? contact::ContactFace::front : contact::ContactFace::back;
  c.shape = met.shape;
  // Where the way passed from one shape to another, it may not have done so before the surface.
  c.from = start_shape;
  if (felt.passed) {
    const contact::Contact until = volume_.cross(start, met.point_mm, start_shape, faces);
    c.from = until.hit ? until.from : until.into;
  }
  c.into = c.from;
  c.passed = c.from != start_shape;
  return c;
}

}  // namespace trephine::touch
