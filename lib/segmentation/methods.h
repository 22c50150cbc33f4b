// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "segmentation/bits.h"
#include "segmentation/segment.h"

namespace trephine::segmentation {

/// The volume's samples as float, whichever type they are stored in.
class HuView {
 public:
  explicit HuView(const HuVolume& v)
      : i16_(std::get_if<Grid<std::int16_t>>(&v)), f32_(std::get_if<Grid<float>>(&v)), lattice_(lattice_of(v)) {}
  float operator()(std::size_t index) const { return i16_ ? float(i16_->voxels[index]) : f32_->voxels[index]; }
  float operator()(int i, int j, int k) const { return (*this)(lattice_.index(i, j, k)); }
  bool is_integer() const { return i16_ != nullptr; }
  const Lattice& lattice() const { return lattice_; }

 private:
  const Grid<std::int16_t>* i16_;
  const Grid<float>* f32_;
  const Lattice& lattice_;
};

/// The box as float HU.
Grid<float> crop(const HuView& hu, const Box& box);

/// The box of voxels whose centres lie within the region of interest; throws Error 80 where there are none, 64 where
/// its lower corner lies beyond its upper one.
Box region_of_interest(const Lattice& lattice, const SegmentParams& params);

struct FillRule {
  double close_mm = 0;
  double max_ml = 1000;
  bool cut_open = false;  ///< a cavity that only one face of the lattice cuts open is enclosed
};
/// What is not in `shape` and cannot be reached from outside: the outside are the components of the closed shape's
/// complement that touch the lattice's edge or exceed max_ml, grown back by close_mm along free ways.
BitMask holes(const BitMask& shape, const FillRule& rule, const Progress& progress = {});

/// Throws Error 80 where the mask is empty, all of the volume, or flat; adds "voxels_count" and "volume_ml".
void check_mask(const BitMask& mask, std::size_t volume_voxels, Report& report);

/// Throws Error 80 where all voxels are alike: a volume that shows nothing of what other fields say is in it.
void check_varies(const HuVolume& volume);

/// Bone of the volume where no skull is given: hysteresis 226 / 400 HU, pieces of at least 1 ml.
BitMask bone_of(const HuView& hu);

/// The cranial cavity on the volume's lattice: not bone, inside. Throws Error 80 where no space enclosed by bone is
/// found.
BitMask cranial_cavity(const BitMask& bone, Report& report, const Progress& progress);

/// Ventricles in tissue as soft_tissue() gives it, within the brain's envelope (sulci filled): CSF between `lower_hu`
/// and `upper_hu` deep in it, parted from cisterns, the fourth ventricle and sulci at the narrowest places. Empty where
/// there is none. `others` gets that CSF which it is parted from.
BitMask find_ventricles(const Grid<float>& soft, const BitMask& envelope, double lower_hu, double upper_hu,
                        const Progress& progress, BitMask* others = nullptr);

Field segment_threshold(const HuView& hu, const SegmentMasks& masks, const SegmentParams& params, Report& report,
                        const Progress& progress);
Field segment_brain(const HuView& hu, const SegmentMasks& masks, const SegmentParams& params, Report& report,
                    const Progress& progress);
Field segment_ventricles(const HuView& hu, const SegmentMasks& masks, const SegmentParams& params, Report& report,
                         const Progress& progress);

}  // namespace trephine::segmentation
