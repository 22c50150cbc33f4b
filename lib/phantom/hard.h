// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "base/params.h"

namespace trephine::phantom {

enum class Blood { none, intracerebral, subdural, intraventricular };

/// What makes a hospital's head harder than a textbook's. Of effect at level `hard` only, where `Head::label` also
/// knows cervical vertebrae and apparatus, and `Head::thing` says which thing lies where. The patient lies supine:
/// couch and clamps are at the back.
struct HardParams {
  bool mask = false, couch = false, clamps = false, board = false, shoulders = false;
  bool burr_hole = false, craniectomy = false, shunt = false, plexus = false, contrast = false, clip = false;
  Blood blood = Blood::none;
  double blood_ml = 0;
  double asymmetry_ratio = 0, motion_mm = 0, motion_z_mm = 45;
  int fillings_count = 1;
  double sharpen_ratio = 0, second_kernel_mm = 0, second_sharpen_ratio = 2;

  template <class V>
  static void describe(V& v) {
    using P = HardParams;
    v.flag(&P::mask, "mask",
           "Level hard: a perforated thermoplastic mask on the face, lifting off at nose, chin and ears.");
    v.flag(&P::couch, "couch", "Level hard: a couch with its cradle and a head rest, instead of the table's holder.");
    v.flag(&P::clamps, "clamps",
           "Level hard: the blocks that hold the mask, beside the head, and balls of metal on it.");
    v.flag(&P::board, "board",
           "Level hard: a flat board of plastic under head and shoulders, which touch it, as long as the scan.");
    v.flag(&P::shoulders, "shoulders", "Level hard: shoulders below the neck.");
    v.flag(&P::burr_hole, "burr_hole", "Level hard: an old burr hole, right frontal, of 14 mm.");
    v.flag(&P::craniectomy, "craniectomy", "Level hard: a piece of the left calvaria of 9 cm is missing.");
    v.flag(&P::shunt, "shunt", "Level hard: a catheter from the right frontal horn through a burr hole to a valve.");
    v.flag(&P::plexus, "plexus", "Level hard: calcified choroid plexus, pineal gland and falx.");
    v.flag(&P::contrast, "contrast", "Level hard: contrast agent in arteries and venous sinuses.");
    v.flag(&P::clip, "clip", "Level hard: an aneurysm clip beside the sella, with streaks.");
    v.choice(&P::blood, "blood",
             {{"none", Blood::none},
              {"intracerebral", Blood::intracerebral},
              {"subdural", Blood::subdural},
              {"intraventricular", Blood::intraventricular}},
             "Level hard: fresh blood.");
    v.number(
        &P::blood_ml, "blood_ml", Range{0, 120},
        "Level hard: about how much fresh blood there is, as far as its place holds so much; 0: what is usual there.");
    v.number(&P::asymmetry_ratio, "asymmetry_ratio", Range{0, 0.6},
             "Level hard: by how much one lateral ventricle is thinner than the other; the seed says which.");
    v.number(&P::motion_mm, "motion_mm", Range{0, 10},
             "Level hard: the head moved by that much while it was scanned, so that its upper part lies aside.");
    v.number(&P::motion_z_mm, "motion_z_mm", Range{-100, 200}, "Level hard: height at which the head moved.");
    v.integer(&P::fillings_count, "fillings_count", Range{0, 6}, "Level hard: metal fillings.");
    v.number(
        &P::sharpen_ratio, "sharpen_ratio", Range{0, 8},
        "Level hard: edge enhancement of the kernel: how many times what it keeps beyond a kernel twice as wide is "
        "added. It enhances noise as well: noise_hu is what the kernel would have without it.");
    v.number(&P::second_kernel_mm, "second_kernel_mm", Range{0, 5},
             "Level hard: kernel of a second series of the same scan, in the same folder; 0: no second series.");
    v.number(&P::second_sharpen_ratio, "second_sharpen_ratio", Range{0, 8},
             "Level hard: edge enhancement of the second series.");
  }
};

/// What a voxel holds beside a healthy head's tissue.
enum class Thing : std::uint8_t {
  none = 0,
  mask = 1,
  couch = 2,
  head_rest = 3,
  clamp = 4,
  marker = 5,
  board = 6,
  blood = 10,
  calcification = 11,
  catheter = 12,
  metal = 13,
  vessel = 14,
  bone_defect = 15,
};

}  // namespace trephine::phantom
