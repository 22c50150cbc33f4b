// SPDX-License-Identifier: GPL-3.0-or-later
// Contours lie on the surface, and fill to what lies in it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pacs/contours.h"
#include "pacs/elements.h"
#include "pacs/tags.h"
#include "pacs_samples.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

using namespace pacs_samples;

// A shell: a ball with a ball taken out, as a skull is.
surface::TriMesh shell(Vec3 centre, double outer_mm, double inner_mm) {
  surface::TriMesh m = shapes::sphere(6, outer_mm, centre);
  const surface::TriMesh hole = shapes::sphere(5, inner_mm, centre);
  const auto before = std::uint32_t(m.points_mm.size());
  for (std::size_t i = 0; i < hole.points_mm.size(); ++i) m.points_mm.push_back(hole.points_mm[i]);
  for (const auto& t : hole.triangles) m.triangles.push_back({before + t[0], before + t[2], before + t[1]});
  return m;
}

const Vec3 centre{1.1, -1.3, 48};

TEST(Contours, LieOnTheSurfaceAndAreClosedOnTiltedAndUnevenSlices) {
  const surface::TriMesh m = shell(centre, 8, 6);
  for (const double lean : {0.0, 0.25}) {
    pacs::SliceSet slices = slices_at(uneven_mm, lean);
    double most = 0;
    std::size_t lines = 0;
    for (std::size_t k = 0; k < slices.origins_mm.size(); ++k)
      for (const pacs::PlaneLine& line : pacs::contours_on(m, slices, k)) {
        ++lines;
        if (std::abs(pacs::signed_area_mm2(line)) < 1e-6) continue;  // the plane touches a corner
        const bool is_outer = pacs::signed_area_mm2(line) > 0;
        for (const pacs::PlanePoint& p : line) {
          const Vec3 at = slices.origins_mm[k] + slices.u * p.x + slices.v * p.y;
          most = std::max(most, std::abs(norm(at - centre) - (is_outer ? 8 : 6)));
        }
      }
    EXPECT_GT(lines, 10u);
    EXPECT_LT(most, 0.01);  // what the triangles themselves are off the ball
  }
}

TEST(Contours, OfASurfaceWithCornersOnThePlaneAreClosed) {
  const surface::TriMesh box = shapes::box({-5, -5, 40}, {5, 5, 44});
  const pacs::SliceSet slices = slices_at({-2, 0, 2, 4, 6});
  std::vector<double> areas;
  for (std::size_t k = 0; k < 5; ++k) {
    double area = 0;
    for (const auto& line : pacs::contours_on(box, slices, k)) area += pacs::signed_area_mm2(line);
    areas.push_back(area);
  }
  // A corner on the plane counts as above it: the box's bottom is no contour, its top is none either.
  EXPECT_EQ(areas[0], 0);
  EXPECT_NEAR(areas[1] + areas[3], 100, 1e-9);
  EXPECT_NEAR(areas[2], 100, 1e-9);
  EXPECT_EQ(areas[4], 0);
}

TEST(Contours, FillToThePixelsThatLieInTheSurfaceWithAndWithoutKeyholes) {
  const surface::TriMesh m = shell(centre, 8, 6);
  for (const double lean : {0.0, 0.25}) {
    const pacs::SliceSet slices = slices_at(uneven_mm, lean);
    const pacs::SliceBits bits = pacs::bits_inside(m, slices);
    for (std::size_t k = 0; k < bits.size(); ++k) {
      const auto lines = pacs::contours_on(m, slices, k);
      const auto plain = pacs::filled(lines, 37, 29, 0.7, 0.9);
      EXPECT_EQ(pacs::filled(pacs::with_keyholes(lines), 37, 29, 0.7, 0.9), plain);
      EXPECT_EQ(pacs::packed(plain), bits[k].empty() ? std::string((37 * 29 + 7) / 8, '\0') : bits[k]);
      if (lines.size() == 2) {
        EXPECT_EQ(pacs::with_keyholes(lines).size(), 1u);
      }
    }
  }
}

TEST(Contours, OfAStructureSetComeBackAsTheShape) {
  const surface::TriMesh m = shell(centre, 8, 6);
  for (const double lean : {0.0, 0.25}) {
    const pacs::SliceSet slices = slices_at({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17}, lean);
    const auto file = pacs::encode_structure_set(identity(), slices, {{"skull", {0.9, 0.8, 0.7}, &m}});
    const pacs::LabelObject back = decoded(file.bytes);
    ASSERT_EQ(back.segments.size(), 1u);
    EXPECT_EQ(back.segments[0].name, "skull");
    const grid::LabelFile labels = pacs::label_file_of(back);
    const grid::Mask mask = grid::pick_label(labels, "skull").mask;
    double most = 0;
    for (int k = 0; k < mask.size[2]; ++k)
      for (int j = 0; j < mask.size[1]; ++j)
        for (int i = 0; i < mask.size[0]; ++i) {
          const double r = norm(mask.to_world_mm({double(i), double(j), double(k)}) - centre);
          const double from = std::max(r - 8, 6 - r);
          if ((from < 0) != (mask.at(i, j, k) != 0)) most = std::max(most, std::abs(from));
        }
    EXPECT_LT(most, 0.6);  // at the poles a slice's distance counts
  }
}

TEST(Contours, OfAnotherKindOrNonsenseAreRefused) {
  const pacs::SliceSet slices = slices_at(uniform_mm);
  const surface::TriMesh ball = shapes::sphere(3, 5, centre);
  const std::string good = pacs::encode_structure_set(identity(), slices, {{"brain", {}, &ball}}).bytes;
  EXPECT_EQ(fault_of(good), "");
  std::string open = good;
  for (std::size_t at; (at = open.find("CLOSED_PLANAR")) != std::string::npos;) open.replace(at, 13, "OPEN_PLANAR  ");
  EXPECT_NE(fault_of(open).find("holds no closed contour"), std::string::npos);
  for (std::size_t at = 132; at < good.size(); at += 97) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x15);
    const std::string fault = fault_of(bytes);
    EXPECT_TRUE(fault.empty() || fault.substr(0, 2) == "65") << at << " " << fault;
  }
}

// A structure set of squares of 20 mm, as another program might write it.
struct Squares {
  std::string name;
  std::vector<double> heights_mm{};
  double warp_mm = 0;  ///< of one corner, out of the plane
  std::string number{};
};
std::string squares_file(const std::vector<Squares>& rois) {
  std::vector<pacs::Elements> named, drawn;
  for (const Squares& r : rois) {
    const std::string number = r.number.empty() ? std::to_string(named.size() + 1) : r.number;
    std::vector<pacs::Elements> contours;
    for (const double z : r.heights_mm)
      contours.push_back(pacs::Elements()
                             .text(pacs::t_contour_type, "CS", "CLOSED_PLANAR")
                             .text(pacs::t_contour_points, "IS", "4")
                             .text(pacs::t_contour_data, "DS",
                                   fmt::format("0\\0\\{0}\\20\\0\\{0}\\20\\20\\{0}\\0\\20\\{1}", z, z + r.warp_mm)));
    named.push_back(pacs::Elements().text(pacs::t_roi_number, "IS", number).text(pacs::t_roi_name, "LO", r.name));
    drawn.push_back(
        pacs::Elements().text(pacs::t_referenced_roi, "IS", number).sequence(pacs::t_contours, std::move(contours)));
  }
  pacs::Elements e = pacs::described(identity(), "RTSTRUCT", 3, "Squares");
  e.sequence(pacs::t_rois, std::move(named)).sequence(pacs::t_roi_contours, std::move(drawn));
  return pacs::encode_object(std::move(e), pacs::class_rtss, "", false).bytes;
}
// The height over which the label fills the middle of the squares, from the counts of its voxels there.
double filled_mm(const std::string& bytes, const std::string& name) {
  const grid::Mask mask = grid::pick_label(pacs::label_file_of(decoded(bytes)), name).mask;
  double filled = 0;
  for (int k = 0; k < mask.size[2]; ++k) filled += mask.at(mask.size[0] / 2, mask.size[1] / 2, k) * mask.spacing_mm.z;
  return filled;
}

TEST(Contours, WhatAnRoiIsBetweenItsOwnPlanesIsWhateverPlanesOthersHave) {
  const Squares coarse{"coarse", {0, 6, 12, 18}}, fine{"fine", {0, 3, 6, 9, 12, 15, 18}};
  const std::string both = squares_file({coarse, fine});
  EXPECT_NEAR(filled_mm(both, "coarse"), 18, 3.1);
  EXPECT_NEAR(filled_mm(both, "fine"), 18, 3.1);
  const pacs::LabelObject read = decoded(both);
  ASSERT_EQ(read.slices.origins_mm.size(), 7u);
  EXPECT_EQ(read.segments[0].bits, read.segments[1].bits);  // equal squares, so that each plane between is one too
  // Two pieces that lie far apart for their own steps are two, with another's planes between them and without.
  const Squares pieces{"pieces", {0, 3, 6, 9, 30, 33, 36, 39}};
  Squares all{"all", {}};
  for (int k = 0; k < 14; ++k) all.heights_mm.push_back(3 * k);
  for (const auto& set : {squares_file({pieces}), squares_file({pieces, all})})
    EXPECT_NEAR(filled_mm(set, "pieces"), 18, 6.1);
  EXPECT_NEAR(filled_mm(squares_file({pieces, all}), "all"), 39, 3.1);
}

TEST(Contours, PlanesWhoseHeightsDifferByLessThanAContourMayBeOffAreOne) {
  Squares a{"a", {0, 3, 6, 9}}, b{"b", {0.05, 3.06, 6.04, 9.05}, 0.04};
  const std::string both = squares_file({a, b});
  EXPECT_EQ(decoded(both).slices.origins_mm.size(), 4u);
  EXPECT_NEAR(filled_mm(both, "a"), 9, 3.1);
  EXPECT_NEAR(filled_mm(both, "b"), 9, 3.1);
  // Planes of one ROI that lie so near cannot be distinguished from that.
  Squares thin{"thin", {}};
  for (int k = 0; k < 20; ++k) thin.heights_mm.push_back(0.05 * k);
  EXPECT_NE(fault_of(squares_file({thin})).find("ContourData (3006,0050)"), std::string::npos);
}

TEST(Contours, NumbersAndCountsOfRoisBeyondTheirLimitsAreRefused) {
  EXPECT_EQ(fault_of(squares_file({{"a", {0, 3, 6}, 0, "2147483647"}})), "");
  const std::string fault = fault_of(squares_file({{"a", {0, 3, 6}, 0, "1e30"}}));
  EXPECT_EQ(fault.substr(0, 12), "65 ROINumber") << fault;
  EXPECT_NE(fault_of(squares_file(std::vector<Squares>(256, {"a", {0, 3, 6}}))).find("at most 255"), std::string::npos);
}

TEST(EncapsulatedStl, HoldsTheFileBitForBit) {
  const std::string stl = std::string("solid of bytes\0\1\2\xff", 18) + "odd";
  const pacs::ObjectFile made = pacs::encode_stl_object(identity(), "skin", stl);
  EXPECT_NE(made.bytes.find(stl), std::string::npos);
}

}  // namespace
}  // namespace trephine
