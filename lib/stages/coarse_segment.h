// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "segmentation/segment.h"

namespace trephine {

/// As the segment stage takes them.
struct SegmentStageParams : SegmentParams {
  double coarse_mm = 0;

  template <class V>
  static void describe(V& v) {
    Inherited<V> inherited{v};
    SegmentParams::describe(inherited);
    v.number(&SegmentStageParams::coarse_mm, "coarse_mm", Range{0, 10},
             "On cells of about this size, each as bright as its brightest voxel, in a fraction of the time: for an "
             "anatomy that others only lie within; it is up to a cell too large, and its surface has steps; 0: on the "
             "scan's voxels.");
  }

 private:
  /// Declares the base's members as this struct's own.
  template <class V>
  struct Inherited {
    V& v;
    using P = SegmentStageParams;
    void number(double SegmentParams::*m, const char* name, Range range, const char* help) {
      v.number(static_cast<double P::*>(m), name, range, help);
    }
    template <class E>
    void choice(E SegmentParams::*m, const char* name, std::vector<std::pair<std::string, E>> choices,
                const char* help) {
      v.choice(static_cast<E P::*>(m), name, std::move(choices), help);
    }
    template <std::size_t N>
    void number(DefaultBy<double, SegmentMethod, N> SegmentParams::*m, const char* name, Range range, const char* help,
                SegmentMethod SegmentParams::*by, const char* by_name) {
      v.number(static_cast<DefaultBy<double, SegmentMethod, N> P::*>(m), name, range, help,
               static_cast<SegmentMethod P::*>(by), by_name);
    }
    template <class E, std::size_t N>
    void choice(DefaultBy<E, SegmentMethod, N> SegmentParams::*m, const char* name,
                std::vector<std::pair<std::string, E>> choices, const char* help, SegmentMethod SegmentParams::*by,
                const char* by_name) {
      v.choice(static_cast<DefaultBy<E, SegmentMethod, N> P::*>(m), name, std::move(choices), help,
               static_cast<SegmentMethod P::*>(by), by_name);
    }
    template <std::size_t N>
    void numbers(std::array<double, N> SegmentParams::*m, const char* name, Range range, const char* help) {
      v.numbers(static_cast<std::array<double, N> P::*>(m), name, range, help);
    }
  };
};

/// segment() without other anatomies, on cells of whole voxels of about coarse_mm: the shape holds that of the scan's
/// own voxels, as long as it is what exceeds lower_hu. The field is on the volume's raster, in steps of a cell. Throws
/// what segment() throws.
Field segment_coarsely(const HuVolume& volume, const SegmentStageParams& params, Report& report,
                       const Progress& progress = {});

}  // namespace trephine
