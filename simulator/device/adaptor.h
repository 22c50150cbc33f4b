/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREPHINE_ADAPTOR_H
#define TREPHINE_ADAPTOR_H
#include <stdint.h>

/* What a shared library must export so that `trephine-sim servo --device adaptor --adaptor FILE` holds a vendor's
 * device through it. Copy this file; it depends on nothing. All positions are mm and all directions unit vectors in the
 * frame in which the device shall be felt (DICOM patient LPS, or any frame that the options --workspace-... bring
 * there).
 *
 * The program opens one device, starts it, and then calls read and send, in turn, from one thread of its own, about
 * 2,000 times a second. They may take as long as the SDK takes; the servo loop does not wait for them. Functions return
 * 0 where they succeed, unless said otherwise. simulator/adaptors holds those for Force Dimension's and
 * 3D Systems' libraries and for Haply's service. */

#ifdef __cplusplus
extern "C" {
#endif

enum { TREPHINE_ADAPTOR_VERSION = 1 };

typedef struct {
  double tip_mm[3];
  double axis[3];   /* from the tool's tip to its tail */
  double across[3]; /* the direction across it that turns with the tool; zero where the device does not know */
  uint32_t buttons;
} trephine_adaptor_pose;

typedef struct {
  double max_force_n;        /* continuous */
  double damping_n_s_per_mm; /* the device's own; 0 where it is not known */
  double workspace_mm[3];    /* sides of the box that the tip can reach; 0 where it is not known */
} trephine_adaptor_limits_t;

int trephine_adaptor_version(void);                        /* TREPHINE_ADAPTOR_VERSION */
int trephine_adaptor_count(void);                          /* devices that are there; below 0: an error */
int trephine_adaptor_name(int index, char* out, int size); /* ends with 0; of at most 63 characters */
void* trephine_adaptor_open(int index);                    /* NULL where it fails */
int trephine_adaptor_limits(void* device, trephine_adaptor_limits_t* out);
int trephine_adaptor_start(void* device); /* forces may be sent from now on */
int trephine_adaptor_read(void* device, trephine_adaptor_pose* out);
int trephine_adaptor_send(void* device, const double force_n[3], const double torque_n_mm[3]);
void trephine_adaptor_close(void* device); /* with no force */
const char* trephine_adaptor_error(void);  /* what failed last, one line; never NULL */

#ifdef __cplusplus
}
#endif
#endif
