// SPDX-License-Identifier: GPL-3.0-or-later
// Every key of NRRD and NIfTI that changes geometry or scale is honoured, or refused: none is passed over.
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.h"
#include "grid/nifti.h"
#include "grid/nrrd.h"

namespace trephine {
namespace {

std::string nrrd(const std::string& more) {
  return "NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 4\nspace directions: (1,0,0) "
         "(0,2,0) (0,0,3)\nendian: little\nencoding: raw\nspace origin: (10,20,30)\n" +
         more + "\n" + std::string(48, '\0');
}
grid::Lattice lattice_with(const std::string& more) {
  return grid::lattice_of(grid::to_hu(grid::decode_nrrd(nrrd(more)).grid));
}
std::string refused(const std::string& more) {
  try {
    grid::decode_nrrd(nrrd(more));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    return e.field();
  }
  return "";
}

TEST(NrrdUnits, SpaceUnitsScaleTheAxesAndTheOrigin) {
  const struct {
    const char* unit;
    double mm;
  } units[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"inch", 25.4}, {"um", 0.001}, {"Millimeters", 1}};
  for (const auto& u : units) {
    const std::string q = std::string("\"") + u.unit + "\"";
    const grid::Lattice l = lattice_with("space units: " + q + " " + q + " " + q + "\n");
    EXPECT_NEAR(l.spacing_mm.x, u.mm, 1e-12 * u.mm) << u.unit;
    EXPECT_NEAR(l.spacing_mm.z, 3 * u.mm, 1e-12 * u.mm) << u.unit;
    EXPECT_NEAR(l.origin_mm.y, 20 * u.mm, 1e-12 * u.mm) << u.unit;
    EXPECT_EQ(l.direction, Mat3());
  }
  const grid::Lattice mixed = lattice_with("space units: \"mm\" \"cm\" \"mm\"\n");
  EXPECT_EQ(mixed.spacing_mm, (Vec3{1, 20, 3}));
  EXPECT_EQ(refused("space units: \"mm\" \"mm\"\n"), "space units");
  EXPECT_EQ(refused("space units: \"mm\" \"mm\" \"s\"\n"), "space units");
  EXPECT_EQ(refused("space units: \"mm\" \"mm\" \"mm\n"), "space units");
}

TEST(NrrdUnits, FieldsThatContradictAreRefused) {
  EXPECT_EQ(refused("kinds: domain domain domain\nspacings: nan nan nan\n"), "");
  EXPECT_EQ(refused("spacings: 1 2 3\n"), "");
  EXPECT_EQ(refused("spacings: 1 2 4\n"), "spacings");
  EXPECT_EQ(refused("axis mins: 0 0 0\n"), "axis mins");
  EXPECT_EQ(refused("axis mins: nan nan nan\naxis maxs: NaN nan nan\n"), "");
  EXPECT_EQ(refused("units: \"mm\" \"mm\" \"mm\"\n"), "");
  EXPECT_EQ(refused("units: \"cm\" \"cm\" \"cm\"\n"), "units");
  EXPECT_EQ(refused("kinds: domain vector domain\n"), "kinds");
  EXPECT_EQ(refused("old min: -1024\nold max: 3071\n"), "old min");
  EXPECT_EQ(refused("old min: nan\n"), "");
}

std::string nifti(int units, float slope) {
  std::string b(352, '\0');
  const auto put = [&](std::size_t at, auto v) { std::memcpy(b.data() + at, &v, sizeof v); };
  put(0, std::int32_t{348});
  const std::int16_t dim[8] = {3, 2, 2, 2, 1, 1, 1, 1};
  std::memcpy(b.data() + 40, dim, sizeof dim);
  put(70, std::int16_t{4});
  put(72, std::int16_t{16});
  const float pixdim[8] = {1, 1, 2, 3, 0, 0, 0, 0};
  std::memcpy(b.data() + 76, pixdim, sizeof pixdim);
  put(108, 352.f);
  put(112, slope);
  b[123] = static_cast<char>(units);
  put(252, std::int16_t{1});
  std::memcpy(b.data() + 344, "n+1", 4);
  return b + std::string(16, '\1');
}

TEST(NiftiUnits, UnitsAndSlopeAreHonouredOrRefused) {
  const auto spacing = [](int units) {
    return grid::lattice_of(grid::to_hu(grid::decode_nifti(nifti(units, 0)).grid)).spacing_mm;
  };
  EXPECT_EQ(spacing(2), (Vec3{1, 2, 3}));
  EXPECT_EQ(spacing(0), (Vec3{1, 2, 3}));
  EXPECT_EQ(spacing(2 + 8), (Vec3{1, 2, 3})) << "with a unit of time";
  EXPECT_NEAR(spacing(1).y, 2000, 1e-9);
  EXPECT_NEAR(spacing(3).z, 0.003, 1e-12);
  for (const int unit : {4, 5, 6, 7}) EXPECT_THROW(grid::decode_nifti(nifti(unit, 0)), Error) << unit;
  EXPECT_THROW(grid::decode_nifti(nifti(2, std::numeric_limits<float>::infinity())), Error);
  const auto first = [](float slope) {
    return std::get<grid::Grid<std::int16_t>>(grid::decode_nifti(nifti(2, slope)).grid).voxels[0];
  };
  EXPECT_EQ(first(2), 2 * 257);
  EXPECT_EQ(first(0), 257);
  EXPECT_EQ(first(std::numeric_limits<float>::quiet_NaN()), 257) << "none, as some programs write it";
}

}  // namespace
}  // namespace trephine
