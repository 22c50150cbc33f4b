// SPDX-License-Identifier: GPL-3.0-or-later
// Real scans, where they are unpacked: ${TREPHINE_DATA:-$HOME/.cache/trephine-data}. Skipped, with a message, where
// not.
#include <gtest/gtest.h>

#include <cstdlib>
#include <ostream>

#include "base/error.h"
#include "dicom/decode.h"
#include "dicom/import.h"
#include "dicom_synthetic.h"

namespace trephine {
namespace {

std::filesystem::path data(const std::string& name) {
  const char *own = std::getenv("TREPHINE_DATA"), *home = std::getenv("HOME");
  return std::filesystem::path(own ? own : std::string(home ? home : "") + "/.cache/trephine-data") / name;
}
#define NEEDS(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data at " << (path)

struct Expected {
  const char* name;
  std::array<int, 3> size;
  Vec3 spacing_mm;
  double tilt_deg;
  bool resampled;
  double largest_gap_mm, hu_min, hu_max;
};
void PrintTo(const Expected& v, std::ostream* out) { *out << v.name; }

class RealScans : public testing::TestWithParam<Expected> {};

TEST_P(RealScans, GeometryAndRange) {
  const Expected& e = GetParam();
  NEEDS(data(e.name));
  const dicom::ImportResult r = dicom::import_series(data(e.name), {});
  const grid::Lattice& l = grid::lattice_of(r.volume);
  EXPECT_EQ(l.size, e.size);
  EXPECT_LT(norm(l.spacing_mm - e.spacing_mm), 2e-3);
  EXPECT_NEAR(determinant(l.direction), 1, 1e-9);
  EXPECT_NEAR(std::get<double>(*r.report().find("tilt_deg")), e.tilt_deg, 0.01);
  EXPECT_EQ(std::get<bool>(*r.report().find("resampled")), e.resampled);
  EXPECT_NEAR(std::get<double>(*r.report().find("largest_gap_mm")), e.largest_gap_mm, 2e-3);
  EXPECT_EQ(std::get<double>(*r.report().find("hu_min")), e.hu_min);
  EXPECT_EQ(std::get<double>(*r.report().find("hu_max")), e.hu_max);
  EXPECT_TRUE(std::holds_alternative<grid::Grid<std::int16_t>>(r.volume));
}

INSTANTIATE_TEST_SUITE_P(
    D16, RealScans,
    testing::Values(
        Expected{"head_invesalius_0051", {512, 512, 107}, {0.4785, 0.4785, 1.5}, 0, true, 1.5, -1024, 3033},
        Expected{"head_neuronav_C3N-01192", {512, 512, 160}, {0.4746, 0.4746, 1.25}, 0, false, 1.25, -1221, 15720},
        Expected{"head_tilt_varspacing_GE", {512, 611, 37}, {0.4883, 0.4883, 4.002}, -18.5, true, 6.999, -1023, 2121},
        Expected{"phantom_tilt_Philips", {512, 612, 58}, {0.40625, 0.40625, 2.397}, 16.5, true, 2.397, -1024, 804},
        Expected{"phantom_untilted_Philips", {512, 512, 140}, {0.4512, 0.4512, 1}, 0, false, 1, -1024, 1033},
        Expected{"spine_lumbar_hitachi", {512, 512, 100}, {0.276, 0.276, 1}, 0, false, 1, -2000, 1300},
        Expected{"chest_clavicle_LIDC-0314_top80", {512, 512, 80}, {0.78125, 0.78125, 1}, 0, false, 1, -1000, 1979},
        Expected{"labelled_ct_totalseg/ct_dicom_j2k", {512, 512, 20}, {0.97656, 0.97656, 2}, 0, false, 2, -1024, 1839}),
    [](const auto& i) {
      std::string s = i.param.name;
      for (char& c : s)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return s;
    });

TEST(RealDefects, SaidPlainly) {
  NEEDS(data("dicom_series_defects"));
  const auto line = [](const char* name) {
    try {
      dicom::import_series(data("dicom_series_defects") / name, {});
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.line("import");
    }
    return std::string("no error");
  };
  EXPECT_NE(line("sliceincrement/001").find("10.000 mm"), std::string::npos);
  EXPECT_NE(line("sliceincrement/002").find("a slice is missing"), std::string::npos);
  EXPECT_NE(line("notavolume/001").find("1 slice position"), std::string::npos);
  EXPECT_NE(line("slicecount/001").find("MR"), std::string::npos);
  EXPECT_EQ(line("gantrytilting/001"), "no error");
}

std::vector<std::uint8_t> stored(const std::filesystem::path& file) {
  const dicom::FileHeader h = dicom::read_header(file);
  EXPECT_TRUE(h.faults.empty()) << h.faults.front().what;
  std::vector<std::uint8_t> out;
  dicom::read_frames({{&h, 0}}, [&](std::size_t, const std::uint8_t* p) { out.assign(p, p + h.frame_bytes()); });
  return out;
}

TEST(RealSyntaxes, EncodersOfOthers) {
  const auto folder = data("dicom_transfer_syntaxes");
  NEEDS(folder);
  for (const char* image : {"CT1", "CT2"}) {
    const auto truth = stored(folder / (std::string(image) + "_UNC"));
    ASSERT_FALSE(truth.empty());
    for (const char* lossless : {"_RLE", "_JPLL", "_JLSL", "_J2KR"})
      EXPECT_EQ(stored(folder / (image + std::string(lossless))), truth) << image << lossless;
    for (const char* lossy : {"_JLSN", "_J2KI"}) {
      const auto near = stored(folder / (image + std::string(lossy)));
      ASSERT_EQ(near.size(), truth.size());
      double sum = 0;
      for (std::size_t i = 0; i < near.size(); i += 2)
        sum += std::abs(static_cast<std::int16_t>(dicom::le16(&near[i])) -
                        static_cast<std::int16_t>(dicom::le16(&truth[i])));
      EXPECT_LT(sum / (near.size() / 2), 30) << image << lossy;
    }
  }
}

TEST(RealOddFiles, NoneKillsTheParent) {
  const auto folder = data("dicom_odd_files");
  NEEDS(folder);
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    try {
      const dicom::FileHeader h = dicom::read_header(entry.path());
      if (!h.is_ct() || !h.faults.empty()) continue;
      dicom::read_frames({{&h, 0}}, [&](std::size_t, const std::uint8_t*) { ++read; });
    } catch (const dicom::WalkFault&) {
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal) << entry.path();
    }
  }
  EXPECT_GE(read, 2);
}

}  // namespace
}  // namespace trephine
