// SPDX-License-Identifier: GPL-3.0-or-later
// P4 on what a page holds: CT and surfaces are read back from the HTML and held against the original skin.
#include <gtest/gtest.h>

#include "base/error.h"
#include "case_samples.h"
#include "face/face_gate.h"
#include "grid/nrrd.h"
#include "head_recipe.h"
#include "meshing/contour.h"
#include "page/case_page.h"
#include "page_reading.h"
#include "phantom_heads.h"
#include "report_of.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

struct Patient {
  grid::HuVolume volume;
  grid::Field skin;
  face::FaceRegion region;
};

Patient patient() {
  const phantom::Head head = phantom_heads::head_of(phantom::Level::simple, 7);
  Patient p;
  p.volume = phantom::volume_of(phantom::scan(head, phantom_heads::scan_of(150, 80, 12)));
  p.skin = segmentation::segment(p.volume, {}, head_recipe::skin()).value;
  p.region = face::face_region(phantom_heads::face_landmarks(head));
  return p;
}

// The page of a case of skin and CT.
std::string page_of(const grid::HuVolume& volume) {
  Report report;
  surface::TriMesh skin =
      value_of(report, meshing::contour(value_of(report, segmentation::segment(volume, {}, head_recipe::skin())), {}));
  case_samples::MemoryCase c;
  cases::CaseManifest& m = c.manifest;
  m.case_token = "head";
  m.program_version = "trephine 0.1.0";
  m.center_mm = {0, 0, 50};
  m.input_sha256 = sha256_of_bytes("input");
  const auto add = [&](const std::string& stem, const std::string& extension, const std::string& bytes) {
    m.files.push_back(cases::describe_case_file(stem, extension, bytes));
    c.files[m.files.back().name] = bytes;
    return m.files.back().name;
  };
  cases::GlbParams glb;
  glb.center_mm = m.center_mm;
  glb.name = "skin";
  cases::CaseAnatomy a;
  a.name = "skin";
  a.file = add("meshes/skin", ".glb", cases::make_glb(skin, glb));
  a.triangles = skin.triangles.size();
  a.points = skin.points_mm.size();
  a.volume_ml = surface::volume_mm3(skin) / 1000;
  a.area_cm2 = surface::area_mm2(skin) / 100;
  m.anatomies.push_back(a);
  const auto& grid = std::get<grid::Grid<std::int16_t>>(volume);
  m.ct = {add("ct", ".nrrd", grid::encode_nrrd(volume, {}, grid::NrrdEncoding::gzip)), grid.size, grid.spacing_mm};
  c.seal();
  return page::make_case_page(cases::load_case_through(c.reader(), cases::LoadParts{true}), {});
}

// The gate on what is read back.
double distance_mm(const Patient& p, const std::string& html) {
  const page_reading::Page page = page_reading::read_page(html);
  const grid::HuVolume ct(page.ct());
  const auto all =
      face::face_distances(p.skin, p.region, {{"skin", &page.surfaces.at(0).mesh}}, {face::face_volume("CT", ct)});
  EXPECT_EQ(all.size(), 2u);
  return std::min(all.at(0).distance_mm, all.at(1).distance_mm);
}

TEST(PageFace, NoPageShowsAFaceThatWasTakenAway) {
  const Patient p = patient();
  EXPECT_LT(distance_mm(p, page_of(p.volume)), 1) << "the control: a face is there";
  for (const face::FaceRemoval policy : {face::FaceRemoval::deface, face::FaceRemoval::crop}) {
    face::DefaceParams params;
    params.policy = policy;
    Report report;
    EXPECT_GE(distance_mm(p, page_of(value_of(report, face::deface(p.volume, p.skin, p.region, params)))),
              face::face_clearance_mm);
  }
}

}  // namespace
}  // namespace trephine
