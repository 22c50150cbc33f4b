// SPDX-License-Identifier: GPL-3.0-or-later
// Transform files against what ITK's own writers put into them.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/write_file.h"
#include "itk/transform.h"
#include "itk/transform_file.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

constexpr const char* head_line = "#Insight Transform File V1.0\n#Transform 0\n";

itk::LinearMap read(const std::string& rest) { return itk::decode_tfm(head_line + rest); }

std::string fault(const std::string& text) {
  try {
    itk::decode_tfm(text);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    return e.field() + ": " + e.what();
  }
  return "";
}

}  // namespace

TEST(Transform, SurvivesItsFile) {
  const itk::LinearMap map = itk::rigid_map({12.5, -33, 71}, {3, -4, 100.25}, {10, 20, -30});
  const itk::LinearMap back = itk::decode_tfm(itk::encode_tfm(map));
  EXPECT_TRUE(back.matrix == map.matrix);
  EXPECT_TRUE(back.offset_mm == map.offset_mm);
  EXPECT_TRUE(itk::is_rigid(map));
  const Vec3 p{3, 5, 7};
  EXPECT_LT(norm(itk::inverse(map)(map(p)) - p), 1e-12);
  EXPECT_LT(norm(itk::then(map, map)(p) - map(map(p))), 1e-12);
  EXPECT_NEAR(itk::angle_deg(itk::rigid_map({0, 0, 25}, {}, {1, 2, 3})), 25, 1e-9);
}

// itk::Euler3DTransform: turned by z * x * y unless the fourth fixed parameter says z * y * x, about the centre.
TEST(Transform, ReadsRigidOnesOfItk) {
  const itk::LinearMap e =
      read("Transform: Euler3DTransform_double_3_3\nParameters: 0.1 0.2 0.3 1 2 3\nFixedParameters: 10 20 30 0\n");
  // Written by ITK 5.2's Euler3DTransform::GetMatrix() and TransformPoint of (1, 2, 3).
  EXPECT_NEAR(e.matrix.column[0].x, 0.930432063657, 1e-11);
  EXPECT_NEAR(e.matrix.column[1].x, -0.294043836552, 1e-11);
  EXPECT_LT(norm(e({1, 2, 3}) - Vec3{2.013709930145, 3.051243873637, 6.652490970795}), 1e-11);
  const itk::LinearMap zyx =
      read("Transform: Euler3DTransform_double_3_3\nParameters: 0.1 0.2 0.3 1 2 3\nFixedParameters: 10 20 30 1\n");
  const double k = 57.29577951308232;
  const itk::LinearMap own = itk::rigid_map({0.1 * k, 0.2 * k, 0.3 * k}, {1, 2, 3}, {10, 20, 30});
  for (int a = 0; a < 3; ++a) EXPECT_LT(norm(zyx.matrix.column[a] - own.matrix.column[a]), 1e-12);
  const itk::LinearMap v = read(
      "Transform: VersorRigid3DTransform_double_3_3\r\nParameters: 0 0 0.25881904510252074 5 0 0\r\nFixedParameters: 0 "
      "0 0\r\n");
  EXPECT_NEAR(itk::angle_deg(v), 30, 1e-9);
  EXPECT_LT(norm(v({1, 0, 0}) - Vec3{5 + std::sqrt(0.75), 0.5, 0}), 1e-12);
}

TEST(Transform, RefusesWhatIsNone) {
  const std::string affine = "Transform: AffineTransform_double_3_3\n", fixed = "FixedParameters: 0 0 0\n";
  EXPECT_NE(fault("hello"), "");
  EXPECT_NE(fault(head_line), "");
  EXPECT_NE(fault(head_line + affine + "Parameters: 1 0 0 0 1 0 0 0 1 0 0\n" + fixed).find("12 numbers"),
            std::string::npos);
  EXPECT_NE(fault(head_line + affine + "Parameters: 1 0 0 0 1 0 0 0 nan 0 0 0\n" + fixed).find("finite"),
            std::string::npos);
  EXPECT_NE(fault(head_line + affine + "Parameters: 1 0 0 1 0 0 0 0 1 0 0 0\n" + fixed).find("inverted"),
            std::string::npos);
  EXPECT_NE(fault(head_line + affine + affine).find("twice"), std::string::npos);
  EXPECT_NE(
      fault(std::string(head_line) + "Transform: BSplineTransform_double_3_3\nParameters: 1\n" + fixed).find("affine"),
      std::string::npos);
}

// HDF5, which ITK reads and a composite of which 3D Slicer and ANTs write.
TEST(Transform, SurvivesHdf5) {
  const ScratchFolder folder;
  const itk::LinearMap map = itk::rigid_map({12.5, -33, 71}, {3, -4, 100.25}, {10, 20, -30});
  const auto file = folder.path() / "t.h5";
  itk::write_transform(file, map);
  const itk::LinearMap back = itk::read_transform(file);
  EXPECT_TRUE(back.matrix == map.matrix);
  EXPECT_TRUE(back.offset_mm == map.offset_mm);
  const std::vector<char> once = read_file(file);
  timespec second{1, 100000000};
  nanosleep(&second, nullptr);
  itk::write_transform(file, map);
  EXPECT_EQ(read_file(file), once) << "no date in it";
  itk::write_transform(folder.path() / "t.tfm", map);
  EXPECT_TRUE(itk::read_transform(folder.path() / "t.tfm").matrix == map.matrix);
  EXPECT_THROW(itk::write_transform(folder.path() / "t.txt", map), Error);
  for (const std::size_t cut : {std::size_t{0}, once.size() / 3, once.size() - 100}) {
    write_file(file, {once.data(), cut});
    try {
      itk::read_transform(file);
      ADD_FAILURE() << "read although cut short at " << cut;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input) << e.what();
    }
  }
  // A byte here and there damaged: the map, another one, or refused, and the process lives.
  for (std::size_t at = 0; at < once.size(); at += 97) {
    std::vector<char> mutant = once;
    mutant[at] = static_cast<char>(~mutant[at]);
    write_file(file, {mutant.data(), mutant.size()});
    try {
      itk::read_transform(file);
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal) << e.what();
    }
  }
}
