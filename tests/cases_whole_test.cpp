// SPDX-License-Identifier: GPL-3.0-or-later
// A case read as `check` and `library verify` read it: every file as its consumers do, and figures that stand twice
// compared.
#include <gtest/gtest.h>

#include <functional>

#include "case_samples.h"
#include "grid/nrrd.h"
#include "voxel/cut.h"

namespace trephine {
namespace {

using case_samples::MemoryCase;

// A case with a CT of 2 mm around everything, and what edits it before it is sealed.
MemoryCase case_with_ct(const std::function<void(grid::Grid<std::int16_t>&, cases::CaseManifest&)>& edit = {}) {
  MemoryCase c = case_samples::minimal_case();
  cases::CaseManifest& m = c.manifest;
  grid::Lattice l;
  l.size = {90, 90, 90};
  l.spacing_mm = {2, 2, 2};
  l.origin_mm = m.center_mm - Vec3{89, 89, 89};
  grid::Grid<std::int16_t> ct(l, 40);
  m.ct = {"", ct.size, ct.spacing_mm};
  if (edit) edit(ct, m);
  const std::string bytes = grid::encode_nrrd(ct, {}, grid::NrrdEncoding::gzip);
  m.files.push_back(cases::describe_case_file("ct", ".nrrd", bytes));
  m.ct.file = m.files.back().name;
  c.files[m.ct.file] = bytes;
  c.seal();
  return c;
}

std::string whole_refusal(const MemoryCase& c) {
  try {
    cases::load_case_through(c.reader(), cases::whole_case);
  } catch (const Error& e) {
    return std::to_string(int(e.code())) + " " + e.field();
  }
  return "";
}

TEST(LoadCase, EveryFileIsReadAsItsConsumersReadIt) {
  EXPECT_EQ(whole_refusal(case_with_ct()), "");
  using Ct = grid::Grid<std::int16_t>;
  const auto faults = [](const std::function<void(Ct&, cases::CaseManifest&)>& edit) {
    return whole_refusal(case_with_ct(edit));
  };
  EXPECT_EQ(faults([](Ct& ct, cases::CaseManifest&) { ct.spacing_mm = {4, 2, 2}; }), "65 spacing_mm");
  EXPECT_EQ(faults([](Ct&, cases::CaseManifest& m) { m.ct.spacing_mm = {2, 2, 4}; }), "65 spacing_mm");
  EXPECT_EQ(faults([](Ct&, cases::CaseManifest& m) { m.ct.size = {90, 90, 91}; }), "65 size");
  // Where file and manifest agree, the CT still has to lie where the rest does.
  EXPECT_EQ(faults([](Ct& ct, cases::CaseManifest& m) {
              ct.spacing_mm = m.ct.spacing_mm = {0.5, 0.5, 0.5};
            }),
            "65 space origin");
  EXPECT_EQ(faults([](Ct& ct, cases::CaseManifest&) { ct.origin_mm.x += 1000; }), "65 space origin");
  // Bytes that are no volume at all.
  MemoryCase c = case_with_ct();
  for (const std::size_t at : {std::size_t{0}, std::size_t{40}, c.files.at(c.manifest.ct.file).size() - 5}) {
    MemoryCase broken = c;
    std::string& bytes = broken.files.at(broken.manifest.ct.file);
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    broken.seal();
    EXPECT_EQ(whole_refusal(broken).substr(0, 2), "65") << at;
    EXPECT_NO_THROW(cases::load_case_through(broken.reader())) << "who does not ask for the CT has it hashed alone";
  }
}

TEST(LoadCase, FiguresThatStandTwiceAreCompared) {
  MemoryCase c = case_samples::minimal_case();
  cases::CaseShape& outer = c.manifest.haptic.shapes[0];
  const voxel::HapticVolume felt = cases::load_case_through(c.reader()).haptic;
  outer.volume_ml = voxel::shape_volume_mm3(felt, outer.number) / 1000;
  c.manifest.figures = {{"outer_ml", c.manifest.anatomies[0].volume_ml}};
  c.seal();
  EXPECT_EQ(whole_refusal(c), "");
  MemoryCase wrong = c;
  wrong.manifest.haptic.shapes[0].volume_ml *= 1.01;
  wrong.seal();
  EXPECT_EQ(whole_refusal(wrong), "65 shapes.outer.volume_ml");
  wrong = c;
  wrong.manifest.figures[0].second = c.manifest.anatomies[0].volume_ml * 1.01;
  wrong.seal();
  EXPECT_EQ(whole_refusal(wrong), "65 figures.outer_ml");
}

}  // namespace
}  // namespace trephine
