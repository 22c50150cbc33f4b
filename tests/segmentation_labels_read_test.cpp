// SPDX-License-Identifier: GPL-3.0-or-later
// Every format's voxels and places come back; damaged and hostile files are refused.
#include <gtest/gtest.h>

#include "base/error.h"
#include "grid/labels.h"
#include "grid/nifti.h"
#include "random.h"
#include "segmentation_labels_writers.h"

namespace trephine {
namespace {

/// Oblique, anisotropic.
grid::Lattice oblique() {
  grid::Lattice l;
  l.size = {7, 6, 5};
  l.spacing_mm = {0.5, 0.75, 2.5};
  l.origin_mm = {12, -34, 56};
  const double a = 0.3, b = -0.2;
  l.direction.column[0] = {std::cos(a), std::sin(a), 0};
  l.direction.column[1] = {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  l.direction.column[2] = cross(l.direction.column[0], l.direction.column[1]);
  return l;
}

TestLabels counted(const grid::Lattice& l) {
  TestLabels t{l, 1, {}};
  for (std::size_t v = 0; v < l.count(); ++v) t.values.push_back(int(v % 5));
  return t;
}

void expect_lattice(const grid::Lattice& is, const grid::Lattice& want, double off_mm) {
  ASSERT_EQ(is.size, want.size);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 at;
    for (int a = 0; a < 3; ++a) at[a] = corner >> a & 1 ? want.size[a] - 1.0 : 0;
    EXPECT_LT(norm(is.to_world_mm(at) - want.to_world_mm(at)), off_mm);
  }
}

void expect_values(const grid::LabelFile& map, const TestLabels& t) {
  for (int value = 1; value <= 4; ++value) {
    const grid::PickedLabel p = grid::pick_label(map, std::to_string(value));
    ASSERT_EQ(p.mask.voxels.size(), t.values.size());
    for (std::size_t v = 0; v < t.values.size(); ++v) ASSERT_EQ(p.mask.voxels[v], t.values[v] == value) << v;
  }
}

TEST(Nifti, EveryDatatypeFormAndByteOrder) {
  const TestLabels t = counted(oblique());
  for (const int datatype : {2, 4, 8, 16, 64, 256, 512, 768, 1024, 1280})
    for (const int version : {1, 2})
      for (const Form form : {Form::sform, Form::qform})
        for (const bool big : {false, true}) {
          NiftiStyle s;
          s.version = version;
          s.form = form;
          s.big_endian = big;
          s.datatype = datatype;
          s.gzip = datatype % 3 == 1;
          s.extension_bytes = datatype == 8 ? 160 : 0;
          SCOPED_TRACE(std::to_string(datatype) + " " + std::to_string(version) + " " + std::to_string(int(form)) +
                       std::to_string(big));
          const grid::LabelFile map = grid::decode_labels(nifti_bytes(t, s));
          EXPECT_EQ(map.format, "NIfTI");
          EXPECT_TRUE(map.warnings.empty());
          expect_lattice(map.lattice, t.lattice, 1e-4);
          expect_values(map, t);
        }
}

TEST(Nifti, LeftHandedGridsUnitsAndScaling) {
  TestLabels t = counted(oblique());
  t.lattice.direction.column[2] = -t.lattice.direction.column[2];
  for (const Form form : {Form::sform, Form::qform})
    for (const double per_mm : {1.0, 0.001, 1000.0}) {
      NiftiStyle s;
      s.form = form;
      s.per_mm = per_mm;
      s.slope = 0.5;
      s.inter = -2;
      const grid::LabelFile map = grid::decode_labels(nifti_bytes(t, s));
      expect_lattice(map.lattice, t.lattice, 1e-3);
      expect_values(map, t);
    }
}

TEST(Nifti, WithoutAFrameItSaysSo) {
  NiftiStyle s;
  s.form = Form::pixdim;
  const grid::LabelFile map = grid::decode_labels(nifti_bytes(counted(oblique()), s));
  ASSERT_EQ(map.warnings.size(), 1u);
  EXPECT_NE(map.warnings[0].find("neither"), std::string::npos);
}

TEST(Nifti, MultiMemberGzipIsOneStream) {
  const TestLabels t = counted(oblique());
  const std::string plain = nifti_bytes(t, {});
  const std::string two =
      grid::detail::gzip_compress(plain.substr(0, 400)) + grid::detail::gzip_compress(plain.substr(400));
  expect_values(grid::decode_labels(two), t);
}

std::string refusal(const std::string& bytes) {
  try {
    grid::decode_labels(bytes);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    return e.field();
  }
  return "taken";
}

TEST(Nifti, RefusesNamingTheField) {
  const std::string good = nifti_bytes(counted(oblique()), {});
  ASSERT_EQ(refusal(good), "taken");
  const auto with = [&](std::size_t at, auto value) {
    std::string bad = good;
    bad.replace(at, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
    return refusal(bad);
  };
  EXPECT_EQ(with(40, std::int16_t{2}), "dim");
  EXPECT_EQ(with(42, std::int16_t{-7}), "dim");
  EXPECT_EQ(with(42, std::int16_t{30000}), "dim");     // more than the file holds
  EXPECT_EQ(with(70, std::int16_t{128}), "datatype");  // RGB
  EXPECT_EQ(with(72, std::int16_t{8}), "bitpix");
  EXPECT_EQ(with(108, -1.f), "vox_offset");
  EXPECT_EQ(with(108, std::nanf("")), "vox_offset");
  EXPECT_EQ(with(108, 1e6f), "vox_offset");
  EXPECT_EQ(with(280, 0.9f), "sform");  // sheared
  EXPECT_EQ(with(280, std::nanf("")), "sform");
  EXPECT_EQ(with(292, std::nanf("")), "sform");
  EXPECT_EQ(with(344, std::uint32_t{0x0031696e}), "magic");  // "ni1": two files
  EXPECT_EQ(refusal(good.substr(0, good.size() - 2)), "dim");
  EXPECT_EQ(refusal(good.substr(0, 200)), "header");
  EXPECT_EQ(refusal(""), "header");
  NiftiStyle zip;
  zip.gzip = true;
  const std::string zipped = nifti_bytes(counted(oblique()), zip);
  EXPECT_EQ(refusal(zipped.substr(0, zipped.size() - 20)), "data");
  NiftiStyle real;
  real.datatype = 16;
  real.slope = 2;  // 0.5, 1, 1.5: no labels
  std::string fractions = nifti_bytes(counted(oblique()), real);
  const float one = 1;
  fractions.replace(112, 4, reinterpret_cast<const char*>(&one), 4);
  EXPECT_EQ(refusal(fractions), "data");
  // 1, 2, 3 less 3: a CT volume's values, no labels.
  std::string negative = nifti_bytes(counted(oblique()), {});
  const float less = -3;
  negative.replace(112, 4, reinterpret_cast<const char*>(&one), 4);
  negative.replace(116, 4, reinterpret_cast<const char*>(&less), 4);
  EXPECT_EQ(refusal(negative), "data");
}

TEST(Nifti, ABombTakesNoMemory) {
  // 30,000^3 voxels claimed by a gzip stream of 1 MB of zeros' worth.
  NiftiStyle s;
  s.datatype = 2;
  std::string bytes = nifti_bytes(counted(oblique()), s);
  const std::int16_t n = 30000;
  for (const std::size_t at : {42, 44, 46}) bytes.replace(at, 2, reinterpret_cast<const char*>(&n), 2);
  bytes.append(std::size_t{64} << 20, '\0');
  EXPECT_EQ(refusal(grid::detail::gzip_compress(bytes)), "dim");
}

TEST(SegNrrd, SegmentsByNameValueAndLayer) {
  TestLabels t{oblique(), 2, {}};
  for (std::size_t v = 0; v < t.lattice.count(); ++v) {
    t.values.push_back(v % 3 == 0 ? 1 : v % 3 == 1 ? 2 : 0);  // layer 0: brain 1, ventricles 2
    t.values.push_back(v % 2 == 0 ? 1 : 0);                   // layer 1: skin 1
  }
  const std::vector<std::string> keys = {
      "Segment0_ID:=Segment_1",      "Segment0_Name:=brain",      "Segment0_LabelValue:=1", "Segment0_Layer:=0",
      "Segment1_ID:=Segment_2",      "Segment1_Name:=Ventricles", "Segment1_LabelValue:=2", "Segment1_Layer:=0",
      "Segment2_ID:=Segment_3",      "Segment2_Name:=skin",       "Segment2_LabelValue:=1", "Segment2_Layer:=1",
      "Segment2_Extent:=0 9 0 5 0 4"};
  for (const bool ras : {false, true}) {
    const grid::LabelFile map = grid::decode_labels(nrrd_bytes(t, keys, ras));
    EXPECT_EQ(map.format, "seg.nrrd");
    EXPECT_EQ(map.layers, 2);
    ASSERT_EQ(map.segments.size(), 3u);
    EXPECT_FALSE(map.segments[0].cropped);
    EXPECT_TRUE(map.segments[2].cropped);
    expect_lattice(map.lattice, t.lattice, 1e-9);
    const auto expect = [&](const char* label, std::size_t layer, int value) {
      const grid::PickedLabel p = grid::pick_label(map, label);
      for (std::size_t v = 0; v < p.mask.voxels.size(); ++v)
        ASSERT_EQ(p.mask.voxels[v], t.values[2 * v + layer] == value) << label << " " << v;
    };
    expect("brain", 0, 1);
    expect("ventricles", 0, 2);  // upper and lower case alike
    expect("Segment_2", 0, 2);
    expect("2", 0, 2);
    expect("skin", 1, 1);
    const auto refused = [&](const char* label) {
      try {
        grid::pick_label(map, label);
        return std::string("taken");
      } catch (const Error& e) {
        EXPECT_EQ(e.field(), "label");
        return std::string(e.what());
      }
    };
    EXPECT_NE(refused("1").find("several"), std::string::npos);
    EXPECT_NE(refused("skull").find("brain (1)"), std::string::npos);
    EXPECT_NE(refused("7").find("skin (1)"), std::string::npos);
  }
}

TEST(SegNrrd, FormerFilesHaveALayerASegment) {
  TestLabels t{oblique(), 2, {}};
  for (std::size_t v = 0; v < t.lattice.count(); ++v) {
    t.values.push_back(v % 3 == 0);
    t.values.push_back(v % 5 == 0);
  }
  const grid::LabelFile map = grid::decode_labels(
      nrrd_bytes(t, {"Segment0_ID:=a", "Segment0_Name:=left", "Segment1_ID:=b", "Segment1_Name:=right"}));
  const grid::PickedLabel right = grid::pick_label(map, "right");
  for (std::size_t v = 0; v < right.mask.voxels.size(); ++v) ASSERT_EQ(right.mask.voxels[v], v % 5 == 0);
  const grid::PickedLabel all = grid::pick_label(map, "");
  for (std::size_t v = 0; v < all.mask.voxels.size(); ++v) ASSERT_EQ(all.mask.voxels[v], v % 5 == 0 || v % 3 == 0);
}

TEST(SegNrrd, RefusesNamingTheField) {
  const TestLabels t = counted(oblique());
  EXPECT_EQ(refusal(nrrd_bytes(t, {"Segment0_ID:=a", "Segment0_Layer:=1"})), "Segment0_Layer");
  EXPECT_EQ(refusal(nrrd_bytes(t, {"Segment0_ID:=a", "Segment0_LabelValue:=x"})), "Segment0_LabelValue");
  EXPECT_EQ(refusal(nrrd_bytes(t, {"Segmentation_SourceRepresentation:=Fractional labelmap"})),
            "Segmentation_SourceRepresentation");
}

TEST(LabelMapNrrd, AValueThatIsNotThere) {
  const grid::LabelFile map = grid::decode_labels(nrrd_bytes(counted(oblique()), {}));
  EXPECT_EQ(map.format, "NRRD");
  try {
    grid::pick_label(map, "9");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("1, 2, 3, 4"), std::string::npos) << e.what();
  }
}

/// Truncations and flipped bits: either refused as bad input, or read as something of the size that the file can hold.
TEST(Labels, MutantsNeverCrash) {
  TestLabels two{oblique(), 2, {}};
  for (std::size_t v = 0; v < two.lattice.count() * 2; ++v) two.values.push_back(int(v % 3));
  NiftiStyle zip, second;
  zip.gzip = true;
  second.version = 2;
  second.datatype = 64;
  const std::string bases[] = {
      nifti_bytes(counted(oblique()), {}), nifti_bytes(counted(oblique()), zip),
      nifti_bytes(counted(oblique()), second),
      nrrd_bytes(two, {"Segment0_ID:=a", "Segment0_Name:=x", "Segment0_Layer:=1", "Segment0_Extent:=0 3 0 3 0 3"})};
  Random random(5);
  int taken = 0, refused = 0;
  for (int n = 0; n < 6000; ++n) {
    std::string bytes = bases[n % 4];
    const std::size_t most = n % 2 ? std::min<std::size_t>(bytes.size(), 600) : bytes.size();
    for (int flips = 1 + int(random() * 4); flips > 0; --flips) {
      char& c = bytes[std::size_t(random() * double(most - 1))];
      c = random() < 0.5 ? static_cast<char>(c ^ 1 << int(random() * 8)) : static_cast<char>(random() * 256);
    }
    if (random() < 0.3) bytes.resize(std::size_t(random() * double(bytes.size())));
    try {
      const grid::LabelFile map = grid::decode_labels(bytes);
      const std::size_t samples = std::visit([](const auto& g) { return g.voxels.size(); }, map.samples);
      EXPECT_LE(samples, bytes.size() * 1032);
      grid::pick_label(map, "");
      for (const char* label : {"1", "x"}) try {
          grid::pick_label(map, label);
        } catch (const Error&) {
        }
      ++taken;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input) << e.what();
      ++refused;
    }
  }
  EXPECT_GT(taken, 500);
  EXPECT_GT(refused, 1500);
}

}  // namespace
}  // namespace trephine
