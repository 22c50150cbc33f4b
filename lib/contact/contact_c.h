/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREPHINE_VOXEL_CONTACT_C_H
#define TREPHINE_VOXEL_CONTACT_C_H
#include <stdint.h>

/* Contact with a haptic volume for programs in C and for other haptic libraries: the interface is that of
 * OpenHaptics' intersectSurface callback [Rizzi, chapter 3]. Positions are mm, DICOM patient LPS. Nothing throws. The
 * functions that open and close allocate, the others do not. An object may be used by one thread at a time.
 *
 * Normals come from the ramp of occupancy across a surface, about a voxel to each side. A binary mask (0 and 255) has
 * none: in voxels that are not cubes its normals are off by 31 to 39 degrees (99th percentile), and forces jump. With
 * TREPHINE_HU, bone next to air seems to have a coat, one voxel thick, of the shape whose window holds the HU between
 * the two. The stepped walk may miss a wall of one voxel at any speed; the exact walk misses none. */

#ifdef __cplusplus
extern "C" {
#endif

typedef struct trephine_contact trephine_contact;

enum { TREPHINE_OCCUPANCY = 0, TREPHINE_HU = 1 };     /* encoding, as haptic_volume.h says */
enum { TREPHINE_EXACT = 0, TREPHINE_STEPPED = 1 };    /* walk */
enum { TREPHINE_SUBVOXEL = 0, TREPHINE_NEAREST = 1 }; /* surface */
enum { TREPHINE_FRONT = 1, TREPHINE_BACK = 2, TREPHINE_FRONT_AND_BACK = 3, TREPHINE_NO_FACE = 0 };

/* A window of raw values is a shape; windows are disjoint. Encoding TREPHINE_OCCUPANCY does not look at `low` and
 * `high`. */
typedef struct {
  int32_t number; /* 1 to 32 */
  int16_t low, high;
  int32_t touchable; /* faces that stop the tool, TREPHINE_FRONT and so on; 0: none, it is never met */
} trephine_shape;

/* Copies size[0] * size[1] * size[2] voxels, i fastest. direction: 9 numbers, column by column, orthonormal; NULL: the
 * axes. step_ratio: of the smallest voxel side, for the stepped walk. NULL where an argument is wrong (trephine_error
 * says which) or memory is short. */
trephine_contact* trephine_contact_open(const int16_t* voxels, const int32_t size[3], const double spacing_mm[3],
                                        const double origin_mm[3], const double* direction, int32_t encoding,
                                        const trephine_shape* shapes, int32_t shape_count, int32_t walk,
                                        int32_t surface, double step_ratio);
void trephine_contact_close(trephine_contact* contact);

/* What was wrong with the last call of trephine_contact_open in this thread; "" where nothing was. */
const char* trephine_error(void);

/* 1 and the contact where start to end crosses a touchable face, 0 where not, -1 where a coordinate is not finite.
 * normal is a unit vector towards start; face is TREPHINE_FRONT or TREPHINE_BACK. Outputs may be NULL. */
int32_t trephine_contact_intersect(trephine_contact* contact, const double start[3], const double end[3],
                                   double point[3], double normal[3], int32_t* face, int32_t* shape);

/* A view of one shape: the user data of trephine_intersect_surface. */
typedef struct {
  trephine_contact* contact;
  int32_t shape;
} trephine_shape_view;

/* The same as a callback for libraries that ask shape by shape: 1 only for the shape that was hit. Calls in a row with
 * the same start and end share the walk of the first one, so a tick costs the same for any number of shapes. */
int32_t trephine_intersect_surface(const double start[3], const double end[3], double point[3], double normal[3],
                                   int32_t* face, void* shape_view);

#ifdef __cplusplus
}
#endif
#endif
