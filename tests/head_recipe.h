// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The values of pipelines/ventriculostomy.yaml, and scans of the phantom made into volumes and fields by them.
#include "head/brain.h"
#include "head/ventricles.h"
#include "phantom/head.h"
#include "phantom/phantom.h"
#include "segmentation/segment.h"

namespace trephine::head_recipe {

inline segmentation::SegmentParams skin() {
  segmentation::SegmentParams p;
  p.lower_hu = -475;
  p.open_mm = 3;
  p.components = segmentation::SegmentComponents::largest;
  p.fill = segmentation::SegmentFill::cavities_and_cut;
  p.fill_close_mm = 6;
  return p;
}

inline segmentation::SegmentParams skull() {
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  p.seed_lower_hu = 400;
  p.edge = segmentation::SegmentEdge::half_maximum;
  p.min_component_ml = 1;
  p.fill = segmentation::SegmentFill::cavities;
  p.fill_close_mm = 2;
  p.fill_max_ml = 100;
  return p;
}

inline head::BrainParams brain(double lower_hu = 22.5) {
  head::BrainParams p;
  p.lower_hu = lower_hu;
  return p;
}

/// Each from those before it, as the recipe does.
struct Fields {
  grid::Field skin, skull, brain, ventricles;
};
inline Fields fields_of(const grid::HuVolume& volume, double brain_lower_hu = 22.5) {
  Fields f;
  f.skin = segmentation::segment(volume, {}, skin()).value;
  segmentation::SegmentMasks masks;
  masks.within = &f.skin;
  f.skull = segmentation::segment(volume, masks, skull()).value;
  f.brain = head::find_brain(volume, {&f.skull, nullptr, nullptr, {}}, brain(brain_lower_hu)).value;
  f.ventricles = head::find_ventricles(volume, {&f.brain, nullptr}, {}).value;
  return f;
}

}  // namespace trephine::head_recipe
