/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A peer behind a shared library: it feels the plane z = 0 of the mesh's coordinates from above, whatever the mesh. */
#include <stdlib.h>

#include "peers/peer_abi.h"

typedef struct {
  double spring;
  int pictures;
} stub;

int trephine_peer_version(void) { return TREPHINE_PEER_VERSION; }
const char* trephine_peer_name(void) { return "plane_stub"; }
void* trephine_peer_open(const trephine_peer_mesh* mesh) {
  if (mesh->triangle_count == 0 || mesh->points < 3) return NULL;
  stub* s = malloc(sizeof *s);
  if (s) s->spring = mesh->spring_n_per_mm, s->pictures = 0;
  return s;
}
int trephine_peer_reset(void* peer, const double device_mm[3]) {
  (void)device_mm;
  ((stub*)peer)->pictures = 0;
  return 0;
}
int trephine_peer_client(void* peer, const double device_mm[3]) {
  (void)device_mm;
  ++((stub*)peer)->pictures;
  return 0;
}
int trephine_peer_step(void* peer, const double device_mm[3], double dt_s, double proxy_mm[3], double force_n[3]) {
  const double deep = device_mm[2] < 0 ? -device_mm[2] : 0;
  if (!(dt_s > 0) || deep > 1000) return 1;
  proxy_mm[0] = device_mm[0];
  proxy_mm[1] = device_mm[1];
  proxy_mm[2] = device_mm[2] + deep;
  force_n[0] = force_n[1] = 0;
  force_n[2] = ((stub*)peer)->spring * deep;
  return 0;
}
void trephine_peer_close(void* peer) { free(peer); }
