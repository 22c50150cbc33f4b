// SPDX-License-Identifier: GPL-3.0-or-later
// The finger-proxy algorithm of CHAI3D 3.3 as a peer of `trephine-sim compare --peer` (simulator/peers/peer_abi.h).
// Scenes are in mm, so that CHAI3D's absolute tolerance is 0.0001 mm. Build it as README.md says.
#include <chai3d.h>

#include <climits>
#include <memory>
#include <new>

#include "peer_abi.h"

namespace {

struct Peer {
  chai3d::cWorld world;                  // deletes the mesh, which is its child
  chai3d::cAlgorithmFingerProxy finger;  // one for the mesh, as cToolCursor has it
};

chai3d::cVector3d vector_of(const double* p) { return chai3d::cVector3d(p[0], p[1], p[2]); }

void put(const chai3d::cVector3d& v, double* to) {
  to[0] = v.x();
  to[1] = v.y();
  to[2] = v.z();
}

}  // namespace

extern "C" {

int trephine_peer_version(void) { return TREPHINE_PEER_VERSION; }

const char* trephine_peer_name(void) { return "chai3d"; }

void* trephine_peer_open(const trephine_peer_mesh* given) {
  if (given->points > UINT_MAX || given->triangle_count > INT_MAX) return nullptr;
  try {
    std::unique_ptr<Peer> peer(new Peer);
    std::unique_ptr<chai3d::cMesh> mesh(new chai3d::cMesh);
    for (uint64_t n = 0; n < given->points; ++n) mesh->newVertex(vector_of(given->points_mm + 3 * n));
    for (uint64_t n = 0; n < given->triangle_count; ++n) {
      const uint32_t* t = given->triangles + 3 * n;
      mesh->newTriangle(t[0], t[1], t[2]);
    }
    mesh->computeAllNormals();
    mesh->createAABBCollisionDetector(given->radius_mm);
    mesh->setStiffness(given->spring_n_per_mm);  // friction, shading and texture are off unless they are set
    mesh->setHapticEnabled(true);
    peer->world.addChild(mesh.release());
    peer->world.computeGlobalPositions(false);
    peer->finger.setProxyRadius(given->radius_mm);
    return peer.release();
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

int trephine_peer_reset(void* peer, const double device_mm[3]) {
  Peer* p = static_cast<Peer*>(peer);
  p->finger.initialize(&p->world, vector_of(device_mm));
  return 0;
}

int trephine_peer_client(void* peer, const double device_mm[3]) {
  (void)device_mm;
  static_cast<Peer*>(peer)->world.computeGlobalPositions(true);
  return 0;
}

int trephine_peer_step(void* peer, const double device_mm[3], double dt_s, double proxy_mm[3], double force_n[3]) {
  (void)dt_s;
  Peer* p = static_cast<Peer*>(peer);
  put(p->finger.computeForces(vector_of(device_mm), chai3d::cVector3d(0, 0, 0)), force_n);
  put(p->finger.getProxyGlobalPosition(), proxy_mm);
  return 0;
}

void trephine_peer_close(void* peer) { delete static_cast<Peer*>(peer); }

}  // extern "C"
