/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREPHINE_PEER_ABI_H
#define TREPHINE_PEER_ABI_H
#include <stdint.h>

/* What a shared library must export so that `trephine-sim compare --peer FILE` compares the haptic algorithm in it with
 * the others, such as one of CHAI3D, which Debian does not have. Copy this file; it depends on nothing. Positions are
 * mm, forces N. Functions that return int return 0 where they succeed. All calls come from one thread.
 *
 * The program opens an algorithm on a mesh, and then calls reset once, client once a picture, and step 1,000 times a
 * second of its own time. Forces shall be those of a plain spring between device and proxy, without friction, damping
 * and limits. examples/chai3d_peer is such a library. */

#ifdef __cplusplus
extern "C" {
#endif

enum { TREPHINE_PEER_VERSION = 1 };

typedef struct {
  const double* points_mm; /* three a point; valid while open runs */
  uint64_t points;
  const uint32_t* triangles; /* three points each, counter-clockwise from outside */
  uint64_t triangle_count;
  double spring_n_per_mm, radius_mm; /* radius: of the proxy, where the algorithm has one */
} trephine_peer_mesh;

int trephine_peer_version(void);                          /* TREPHINE_PEER_VERSION */
const char* trephine_peer_name(void);                     /* of a-z, 0-9 and _, at most 31 characters */
void* trephine_peer_open(const trephine_peer_mesh* mesh); /* NULL where it fails */
int trephine_peer_reset(void* peer, const double device_mm[3]);
int trephine_peer_client(void* peer, const double device_mm[3]);
int trephine_peer_step(void* peer, const double device_mm[3], double dt_s, double proxy_mm[3], double force_n[3]);
void trephine_peer_close(void* peer);

#ifdef __cplusplus
}
#endif
#endif
