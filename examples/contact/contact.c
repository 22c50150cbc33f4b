/* SPDX-License-Identifier: GPL-3.0-or-later
 * Contact with a volume from C99: a ball of 600 HU with a core of metal, in air, is touched from six sides. First
 * as a program of one's own asks (trephine_contact_intersect), then as a haptic library's callback does, shape by shape
 * (trephine_intersect_surface). Ends with 0; 1 where a contact is not where the ball is; 70 where nothing opens. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "contact/contact_c.h"

enum { SIZE = 40, CORE = 1, BALL = 2 };
static const double spacing_mm[3] = {0.5, 0.5, 1}, origin_mm[3] = {-10, -10, -20}; /* the ball's middle is at 0 */
static const double radius_mm = 8, core_mm = 3;

static double length(const double* p) { return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); }

/* Bone with a core of metal, in air. */
static int16_t* make_volume(void) {
  int16_t* voxels = malloc(sizeof(int16_t) * SIZE * SIZE * SIZE);
  for (int k = 0; voxels && k < SIZE; ++k)
    for (int j = 0; j < SIZE; ++j)
      for (int i = 0; i < SIZE; ++i) {
        const double p[3] = {origin_mm[0] + i * spacing_mm[0], origin_mm[1] + j * spacing_mm[1],
                             origin_mm[2] + k * spacing_mm[2]};
        const double r = length(p);
        voxels[(k * SIZE + j) * SIZE + i] = (int16_t)(r < core_mm ? 3000 : r < radius_mm ? 600 : -1000);
      }
  return voxels;
}

int main(void) {
  const int32_t size[3] = {SIZE, SIZE, SIZE};
  /* Windows of HU; the core is felt from outside only. */
  const trephine_shape shapes[2] = {{CORE, 2000, 3071, TREPHINE_FRONT}, {BALL, 300, 1999, TREPHINE_FRONT_AND_BACK}};
  int16_t* voxels = make_volume();
  if (!voxels) return 70;
  trephine_contact* contact = trephine_contact_open(voxels, size, spacing_mm, origin_mm, NULL, TREPHINE_HU, shapes, 2,
                                                    TREPHINE_EXACT, TREPHINE_NEAREST, 1);
  free(voxels); /* they were copied */
  if (!contact) return fprintf(stderr, "contact: %s\n", trephine_error()), 70;

  trephine_shape_view views[2] = {{contact, CORE}, {contact, BALL}};
  int wrong = 0;
  for (int side = 0; side < 6; ++side) {
    const double sign = side % 2 ? -1 : 1;
    double start[3] = {0.1, 0.1, 0.1}, end[3] = {0.1, 0.1, 0.1}, point[3], normal[3], again[3];
    start[side / 2] = 15 * sign;
    int32_t face = TREPHINE_NO_FACE, shape = 0;
    const int32_t hit = trephine_contact_intersect(contact, start, end, point, normal, &face, &shape);
    if (hit != 1) {
      printf("nothing was met\n");
      ++wrong;
      continue;
    }
    printf("%s of shape %d at %.2f %.2f %.2f, normal %.2f %.2f %.2f\n", face == TREPHINE_FRONT ? "front" : "back",
           (int)shape, point[0], point[1], point[2], normal[0], normal[1], normal[2]);
    /* Half a voxel is what boxes can be off; the normal looks to where the tool comes from. */
    wrong += shape != BALL || face != TREPHINE_FRONT || fabs(length(point) - radius_mm) > 1 ||
             normal[side / 2] * sign < 0.8;
    wrong += trephine_intersect_surface(start, end, again, normal, &face, &views[0]) != 0;
    wrong += trephine_intersect_surface(start, end, again, normal, &face, &views[1]) != 1 ||
             again[side / 2] != point[side / 2];
    /* From just below the ball's surface on: the core. */
    start[side / 2] = 6 * sign;
    wrong += trephine_contact_intersect(contact, start, end, point, normal, &face, &shape) != 1 || shape != CORE ||
             fabs(length(point) - core_mm) > 1;
  }
  const double nowhere[3] = {NAN, 0, 0}, middle[3] = {0, 0, 0};
  wrong += trephine_contact_intersect(contact, nowhere, middle, NULL, NULL, NULL, NULL) != -1;
  trephine_contact_close(contact);
  if (wrong) printf("%d answers are wrong\n", wrong);
  return wrong != 0;
}
