// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "fluoro/carm.h"
#include "fluoro/fluoro_memory.h"
#include "grid/grid.h"

namespace trephine::fluoro {

struct FluoroPicture {
  int size = 0;
  std::vector<std::uint8_t> grey;  ///< row by row; bone and metal bright, as on a radiograph
};

/// Attenuation of water and of the metal, at about 60 keV.
constexpr double water_per_mm = 0.0206;  ///< 0.206 / cm
constexpr double metal_per_mm = 0.95;    ///< steel: 1.2 cm^2/g at 7.9 g/cm^3

/// Throws Error 65 where a case has none.
void require_ct(const grid::Grid<std::int16_t>& ct);

/// A CT as X-rays see it: mu = mu_water (1 + HU / 1000), at least 0. Each ray is followed slice by slice along the axis
/// that it follows most, with bilinear interpolation in each [Joseph1982]. Rows are computed in parallel; the result
/// does not depend on the number of threads.
class FluoroVolume {
 public:
  explicit FluoroVolume(const grid::Grid<std::int16_t>& ct);
  FluoroIntegrals integrals(const CArm& arm) const;
  /// Some rows of them, into a picture that has its size.
  void integrate(const CArm& arm, int first_row, int end_row, FluoroIntegrals& out) const;
  double along(const CArm::Ray& ray) const;
  Vec3 centre_mm() const;

 private:
  grid::Lattice lattice_;
  std::vector<std::uint16_t> water_;  ///< HU + 1000, at least 0: thousandths of water
};

/// Grey is linear in the integral: 0 is air, 200 the patient's 99.5th percentile of what is not air, `bright`, so that
/// metal stands out before dense bone.
double bright_of(const FluoroIntegrals& patient);
/// The patient's integrals as a picture, with metal in it, which is added as the length of each ray in it.
FluoroPicture picture_of(const FluoroIntegrals& patient, double bright, const CArm& arm,
                         const std::vector<MetalRod>& metal);

/// While the arm stands still only the needle moves: the patient's integrals are remembered (FluoroMemory).
class Fluoroscope {
 public:
  explicit Fluoroscope(const grid::Grid<std::int16_t>& ct) : volume_(ct) {}
  FluoroPicture picture(const CArmParams& arm, int size, const std::vector<MetalRod>& metal);
  const FluoroVolume& volume() const { return volume_; }

 private:
  const KeptFluoro& patient(const CArmParams& arm, int size);
  FluoroVolume volume_;
  FluoroMemory memory_;
};

/// How a monitor shows it: bone and metal bright, as on a film, or dark, as on most C-arms.
enum class MetalShown { bright, dark };
/// `flipped`: left and right exchanged.
std::vector<std::uint8_t> shown_grey(const FluoroPicture& picture, MetalShown how, bool flipped = false);

}  // namespace trephine::fluoro
