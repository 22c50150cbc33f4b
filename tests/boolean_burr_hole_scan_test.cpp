// SPDX-License-Identifier: GPL-3.0-or-later
// Burr holes on the surfaces that the recipe makes of scans: of the phantom, against its truth, and of real heads with
// landmarks given by hand (${TREPHINE_DATA:-$HOME/.cache/trephine-data}; skipped, with a message, where it is not).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "base/pi.h"
#include "boolean/burr_hole.h"
#include "dicom/import.h"
#include "head_recipe.h"
#include "meshing/contour.h"
#include "phantom/phantom.h"
#include "report_of.h"
#include "scratch_folder.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

using Side = boolean::BurrHoleRequest::Side;
using Marks = std::map<std::string, Vec3>;

struct Surfaces {
  surface::TriMesh skin, skull;
};

/// As pipelines/ventriculostomy.yaml does.
Surfaces surfaces_of(const grid::HuVolume& volume) {
  Report report;
  const grid::Field outside = value_of(report, segmentation::segment(volume, {}, head_recipe::skin()));
  segmentation::SegmentMasks masks;
  masks.within = &outside;
  return {value_of(report, meshing::contour(outside, {})),
          value_of(report,
                   meshing::contour(value_of(report, segmentation::segment(volume, masks, head_recipe::skull())), {}))};
}

void expect_kocher(const phantom::PhantomParams& params, const grid::HuVolume& volume, const char* what) {
  const phantom::Head head(params.head);
  const Surfaces s = surfaces_of(volume);
  Marks marks;
  for (const auto& l : head.landmarks()) marks[l.first] = l.second;
  for (const Side side : {Side::left, Side::right}) {
    const char* name = side == Side::left ? "kocher_left" : "kocher_right";
    boolean::BurrHoleRequest r;
    r.side = side;
    r.toward_mm = marks.at(side == Side::left ? "monro_left" : "monro_right");
    const boolean::BurrHole hole = boolean::place_burr_hole(r, marks, &s.skin, s.skull).value;
    const double off = norm(hole.skin_mm - marks.at(name));
    const double beside_skull = head.signed_distance_mm(phantom::Anatomy::skull, hole.position_mm);
    EXPECT_LT(off, 1) << what;
    EXPECT_LT(std::fabs(beside_skull), 0.5) << what;
    const Vec3 way = *r.toward_mm - hole.position_mm;
    EXPECT_LT(norm(way - hole.direction * dot(way, hole.direction)), 1e-6);
    r.toward_mm.reset();
    const boolean::BurrHole upright = boolean::place_burr_hole(r, marks, &s.skin, s.skull).value;
    Vec3 normal;
    head.implicit_mm(phantom::Anatomy::skull, head.project_mm(phantom::Anatomy::skull, upright.position_mm), normal);
    const double tilt = std::acos(std::min(1.0, -dot(normalized(normal), upright.direction))) * 180 / pi;
    EXPECT_LT(tilt, 3) << what;  // of the analytic normal at a point, not the mean over the hole
    std::printf("%s %s: %.3f mm from the truth, %.2f deg off the normal at its middle, skull %.3f mm, bone %.2f mm\n",
                what, name, off, tilt, beside_skull, upright.bone_thickness_mm);
    EXPECT_LE(upright.cutter.depth_mm, upright.bone_thickness_mm + 10);
  }
}

TEST(BurrHoleScan, OfTheSampleCase) {
  const phantom::PhantomParams p = phantom::sample_phantom();
  const auto imported = dicom::import_series(std::string(TREPHINE_SOURCE_DIR) + "/sample_dicom", {});
  expect_kocher(p, imported.volume, "sample");
}

TEST(LongBurrHoleScan, OfATiltedSmallVariantAndOfOneScannedObliquely) {
  for (const bool tilted : {true, false}) {
    phantom::PhantomParams p = phantom::sample_phantom();
    p.head.variant = phantom::Variant::small;
    p.head.seed = 5;
    p.truth.mesh_step_mm = 0;
    p.truth.labels = false;
    if (tilted) p.scan.tilt_deg = 15;
    if (!tilted) p.scan.rotation_deg = {15, -8, 20};
    const ScratchFolder folder;
    phantom::make_phantom(folder.path(), p);
    const auto imported = dicom::import_series(folder.path() / "dicom", {});
    expect_kocher(p, imported.volume, tilted ? "gantry tilt" : "oblique");
  }
}

/// Plausible only: nobody knows the true points.
void expect_plausible(const char* name, const Marks& marks) {
  const char *own = std::getenv("TREPHINE_DATA"), *home = std::getenv("HOME");
  const auto path = std::filesystem::path(own ? own : std::string(home ? home : "") + "/.cache/trephine-data") / name;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data at " << path;
  const Surfaces s = surfaces_of(dicom::import_series(path, {}).volume);
  boolean::BurrHole holes[2];
  for (const Side side : {Side::left, Side::right}) {
    boolean::BurrHoleRequest r;
    r.side = side;
    Report report;
    boolean::BurrHole& hole = holes[side == Side::left];
    hole = value_of(report, boolean::place_burr_hole(r, marks, &s.skin, s.skull));
    const double soft = norm(hole.position_mm - hole.skin_mm);
    std::printf(
        "%s %s: skin [%.1f, %.1f, %.1f], direction [%.3f, %.3f, %.3f], soft tissue %.2f, bone %.2f, depth %.2f\n", name,
        side == Side::left ? "left" : "right", hole.skin_mm.x, hole.skin_mm.y, hole.skin_mm.z, hole.direction.x,
        hole.direction.y, hole.direction.z, soft, hole.bone_thickness_mm, hole.cutter.depth_mm);
    EXPECT_TRUE(report.warnings.empty()) << report.warnings[0];
    EXPECT_GT(soft, 1.5);
    EXPECT_LT(soft, 12);
    EXPECT_GT(hole.bone_thickness_mm, 3);
    EXPECT_LT(hole.bone_thickness_mm, 14);
    EXPECT_LT(hole.direction.z, -0.5);
    EXPECT_EQ(*report.find("on_bone_ratio"), ParameterValue(1.0));
    // The straight way from the nasion is 15 % shorter than the way over the skin.
    const double chord = norm(hole.skin_mm - marks.at("nasion"));
    EXPECT_GT(chord, 85);
    EXPECT_LT(chord, 112);
  }
  EXPECT_NEAR(norm(holes[0].skin_mm - holes[1].skin_mm), 2 * 27.5, 6);
  EXPECT_LT(std::fabs(holes[0].bone_thickness_mm - holes[1].bone_thickness_mm), 3);
}

TEST(LongBurrHoleScan, OfARealHeadFromVertexToUpperJaw) {
  expect_plausible("head_invesalius_0051", {{"nasion", {1.5, -125, 186}}, {"inion", {3, 62, 160}}});
}

TEST(LongBurrHoleScan, OfARealHeadWithAMass) {
  expect_plausible("head_neuronav_C3N-01192", {{"nasion", {-4.1, -50, -11}}, {"inion", {-6, 122, -50}}});
}

}  // namespace
}  // namespace trephine
