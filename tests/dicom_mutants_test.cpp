// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged files: the parent never dies, and what is read of one is what a second, plain reading of the same bytes says:
// no value is made up, none is silently another.
#include <gdcmImage.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmSequenceOfFragments.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "dicom/decode.h"
#include "dicom/hu.h"
#include "dicom/import.h"
#include "dicom_enhanced.h"
#include "dicom_mutator.h"
#include "dicom_naive.h"

namespace trephine {
namespace {

using synthetic::DataSet;
using synthetic::Naive;
using synthetic::Scan;
using synthetic::tag;

struct Seed {
  const char* name;
  std::vector<std::string> others;  ///< the series' other files
  std::string bytes;                ///< the one that is damaged
  std::size_t pixels_at = 0;
};

Scan scan() {
  Scan s;
  s.columns = 14;
  s.rows = 11;
  s.slices = 5;
  s.bits_stored = 12;
  s.blobs = synthetic::four_blobs(6, 3);
  s.edit = [](int, DataSet& d) {
    d.elements[tag(0x28, 0x120)] = {"US", synthetic::little(0, 2), {}};
    d.text(tag(0x8, 0x70), "LO", "A MAKER");
    d.text(tag(0x18, 0x1120), "DS", "0");
    d.text(tag(0x20, 0x13), "IS", "12");
    d.elements[tag(0x29, 0x1010)] = {"UN", std::string(20, '\1'), {}};
    synthetic::sequence(d, tag(0x8, 0x1140), {DataSet{}.bytes()}, false);
  };
  return s;
}

/// The words as a JPEG-LS stream. Not a file by GDCM: that would hold the date.
std::string jpeg_ls_stream(const std::string& words, const Scan& s) {
  gdcm::SmartPointer<gdcm::Image> raw = new gdcm::Image;
  raw->SetNumberOfDimensions(2);
  raw->SetDimension(0, static_cast<unsigned>(s.columns));
  raw->SetDimension(1, static_cast<unsigned>(s.rows));
  raw->SetPixelFormat(gdcm::PixelFormat(1, 16, static_cast<unsigned short>(s.bits_stored),
                                        static_cast<unsigned short>(s.bits_stored - 1), 0));
  raw->SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  raw->SetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  pixels.SetByteValue(words.data(), static_cast<std::uint32_t>(words.size()));
  raw->SetDataElement(pixels);
  gdcm::ImageChangeTransferSyntax change;
  change.SetTransferSyntax(gdcm::TransferSyntax::JPEGLSLossless);
  change.SetInput(*raw);
  EXPECT_TRUE(change.Change());
  const gdcm::ByteValue* stream =
      change.GetOutput().GetDataElement().GetSequenceOfFragments()->GetFragment(0).GetByteValue();
  return std::string(stream->GetPointer(), stream->GetLength());
}

const std::vector<Seed>& seeds() {
  static const std::vector<Seed> all = [] {
    std::vector<Seed> made;
    const auto series = [&](const char* name, const Scan& s) {
      Seed seed{name, {}, {}};
      for (int k = 0; k < s.slices; ++k) {
        std::string bytes = synthetic::file_bytes(s.slice(k), s.syntax);
        if (k == 2)
          seed.bytes = bytes;
        else
          seed.others.push_back(bytes);
      }
      made.push_back(seed);
    };
    Scan implicit = scan(), rle = scan(), jpeg_ls = scan();
    implicit.syntax = "1.2.840.10008.1.2";
    implicit.edit = nullptr;
    rle.syntax = "1.2.840.10008.1.2.5";
    rle.edit = [](int, DataSet& d) {
      auto& pixels = d.elements[tag(0x7fe0, 0x10)];
      pixels = synthetic::encapsulated(synthetic::rle_stream(pixels.bytes));
    };
    jpeg_ls.syntax = "1.2.840.10008.1.2.4.80";
    jpeg_ls.edit = [](int, DataSet& d) {
      auto& pixels = d.elements[tag(0x7fe0, 0x10)];
      pixels = synthetic::encapsulated(jpeg_ls_stream(pixels.bytes, scan()));
    };
    series("explicit", scan());
    series("implicit", implicit);
    series("rle", rle);
    series("jpeg_ls", jpeg_ls);
    made.push_back({"multi_frame", {}, synthetic::file_bytes(synthetic::enhanced(scan(), {3, 0, 4, 1, 2}, false))});
    for (Seed& s : made) s.pixels_at = s.bytes.find(std::string("\xe0\x7f\x10\0", 4));
    return made;
  }();
  return all;
}

/// "" where the header is what the plain reading says.
std::string compare(const dicom::FileHeader& h, const Naive& n) {
  const auto word = [&](std::uint32_t t, int ours, const char* name) {
    const auto v = n.word(t);
    return v && *v == ours ? std::string() : std::string(name) + " ";
  };
  std::string wrong = word(tag(0x28, 0x10), h.rows, "Rows") + word(tag(0x28, 0x11), h.columns, "Columns") +
                      word(tag(0x28, 0x100), h.bits_allocated, "BitsAllocated") +
                      word(tag(0x28, 0x101), h.bits_stored, "BitsStored") +
                      word(tag(0x28, 0x103), h.is_signed, "PixelRepresentation");
  const auto padding = n.word(tag(0x28, 0x120));
  if (padding.has_value() != h.padding.has_value() || (padding && *padding != *h.padding)) wrong += "padding ";
  for (std::size_t f = 0; f < h.frames.size(); ++f) {
    const dicom::Frame& frame = h.frames[f];
    const auto numbers = [&](std::uint32_t t, const std::vector<double>& ours, double tolerance, const char* name) {
      const auto v = n.decimals(t, f);
      bool same = v && v->size() == ours.size();
      for (std::size_t i = 0; same && i < ours.size(); ++i) same = std::abs((*v)[i] - ours[i]) <= tolerance;
      if (!same) wrong += std::string(name) + " ";
    };
    const Vec3 p = *frame.position_mm, a = (*frame.orientation)[0], b = (*frame.orientation)[1];
    numbers(tag(0x20, 0x32), {p.x, p.y, p.z}, 0, "ImagePositionPatient");
    numbers(tag(0x20, 0x37), {a.x, a.y, a.z, b.x, b.y, b.z}, 4e-3, "ImageOrientationPatient");
    numbers(tag(0x28, 0x30), {(*frame.spacing_mm)[1], (*frame.spacing_mm)[0]}, 0, "PixelSpacing");
    if (frame.slope || h.is_ct()) numbers(tag(0x28, 0x1053), {frame.slope.value_or(NAN)}, 0, "RescaleSlope");
    if (frame.intercept || h.is_ct())
      numbers(tag(0x28, 0x1052), {frame.intercept.value_or(NAN)}, 0, "RescaleIntercept");
  }
  return wrong;
}

/// HU of a stored word by PS3.3 C.7.6.3 and C.11.1, straight.
double hu_of(const dicom::FileHeader& h, const dicom::Frame& f, unsigned word, bool& tell) {
  std::int64_t v = word & ((1u << h.bits_stored) - 1);
  if (h.is_signed && v >> (h.bits_stored - 1)) v -= std::int64_t{1} << h.bits_stored;
  tell = !h.padding || (word != *h.padding && (v & 0xffff) != *h.padding);
  return static_cast<double>(v) * *f.slope + *f.intercept;
}

struct Tally {
  int broken = 0, faulty = 0, refused = 0, read = 0, untouched = 0;
};

/// One damaged file alone: its header and pixels against the plain reading.
void check_file(const Seed& seed, const std::string& bytes, const std::string& label, Tally& tally) {
  dicom::FileHeader h;
  try {
    h = dicom::read_header(dicom::Origin::memory(bytes));
  } catch (const dicom::WalkFault&) {
    ++tally.broken;
    return;
  }
  if (!h.faults.empty() || !h.is_ct()) {
    ++tally.faulty;
    return;
  }
  const auto naive = synthetic::NaiveReader(bytes).read();
  ASSERT_TRUE(naive) << label << ": read, but not by the plain reading";
  EXPECT_FALSE(naive->twice && compare(h, *naive) != "") << label;
  EXPECT_EQ(compare(h, *naive), "") << label;
  ASSERT_EQ(static_cast<int>(h.frames.size()), h.frame_count) << label;
  std::vector<dicom::FrameRef> frames;
  for (int f = 0; f < h.frame_count; ++f) frames.push_back({&h, f});
  const bool native = h.syntax->encoding == dicom::Encoding::native;
  const std::size_t size = h.frame_bytes();
  try {
    dicom::HuMapper<float> mapper;
    dicom::read_frames(frames, [&](std::size_t f, const std::uint8_t* stored) {
      if (native) {
        ASSERT_LE((f + 1) * size, naive->pixels.size()) << label;
        EXPECT_EQ(std::memcmp(stored, naive->pixels.data() + f * size, size), 0) << label;
      }
      if (h.bits_allocated != 16) return;
      std::vector<float> hu(size / 2);
      dicom::HuCounts counts;
      mapper.apply(dicom::hu_rule(h, h.frames[f], -1e30, 1e30), stored, hu.size(), hu.data(), counts);
      for (std::size_t i = 0; i < hu.size(); ++i) {
        bool tell = true;
        const double expected = hu_of(h, h.frames[f], dicom::le16(stored + 2 * i), tell);
        ASSERT_TRUE(!tell || hu[i] == static_cast<float>(expected)) << label << hu[i] << " " << expected;
      }
    });
    ++tally.read;
  } catch (const Error& e) {
    EXPECT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal) << label << e.line("");
    ++tally.refused;
  }
  // Where no value that matters changed, and the pixels are the seed's, all is as it was.
  const auto whole = synthetic::NaiveReader(seed.bytes).read();
  ASSERT_TRUE(whole);
  if (naive->pixels == whole->pixels && naive->top == whole->top && naive->frames == whole->frames) ++tally.untouched;
}

/// The series with the damaged file in it: read or refused, never a death, a hang or a volume that is none.
void check_series(const Seed& seed, const std::string& bytes, const std::string& label) {
  const ScratchFolder folder;
  for (std::size_t i = 0; i < seed.others.size(); ++i) folder.write("good" + std::to_string(i), seed.others[i]);
  folder.write("mutant", bytes);
  const auto start = std::chrono::steady_clock::now();
  try {
    const dicom::ImportResult r = dicom::import_series(folder.path(), {});
    std::visit(
        [&](const auto& g) {
          ASSERT_EQ(g.voxels.size(), std::size_t(g.size[0]) * std::size_t(g.size[1]) * std::size_t(g.size[2])) << label;
          for (const auto v : g.voxels) ASSERT_TRUE(std::isfinite(static_cast<double>(v))) << label;
        },
        r.volume);
    EXPECT_NEAR(determinant(grid::lattice_of(r.volume).direction), 1, 1e-6) << label;
  } catch (const Error& e) {
    EXPECT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::usage || e.code() == ExitCode::internal)
        << label << e.line("");
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 600)
      << label << ": it hangs";
}

void run_mutants(int count, std::uint64_t first) {
  Tally tally;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t number = first + static_cast<std::uint64_t>(i);
    const Seed& seed = seeds()[static_cast<std::size_t>(i) % seeds().size()];
    const std::string bytes = synthetic::mutant_of(seed.bytes, seed.pixels_at, number);
    const std::string label = std::string(seed.name) + " mutant " + std::to_string(number) + ": ";
    check_file(seed, bytes, label, tally);
    if (testing::Test::HasFatalFailure()) return;
    check_series(seed, bytes, label);
    if (testing::Test::HasFatalFailure()) return;
  }
  std::printf(
      "%d mutants: %d broken, %d with wrong tags, %d refused on decoding, %d read as they say, %d of them with "
      "nothing of theirs hit\n",
      count, tally.broken, tally.faulty, tally.refused, tally.read, tally.untouched);
  EXPECT_GT(tally.broken, count / 50);
  EXPECT_GT(tally.faulty, count / 50);
  EXPECT_GT(tally.read, count / 50);
}

// To look at one: TREPHINE_MUTANT=name:number, TREPHINE_MUTANT_OUT=FILE.
TEST(LongDicomMutants, WritesWhereAsked) {
  const char *which = std::getenv("TREPHINE_MUTANT"), *out = std::getenv("TREPHINE_MUTANT_OUT");
  if (!which || !out) GTEST_SKIP() << "TREPHINE_MUTANT and TREPHINE_MUTANT_OUT are not set";
  const std::string text = which;
  for (const Seed& seed : seeds())
    if (text.substr(0, text.find(':')) == seed.name)
      std::ofstream(out, std::ios::binary)
          << synthetic::mutant_of(seed.bytes, seed.pixels_at, std::stoull(text.substr(text.find(':') + 1)));
}

TEST(DicomMutants, SeedsAreReadAsTheyAre) {
  for (const Seed& seed : seeds()) {
    Tally tally;
    check_file(seed, seed.bytes, seed.name, tally);
    EXPECT_EQ(tally.read, 1) << seed.name;
    EXPECT_EQ(tally.untouched, 1) << seed.name;
    check_series(seed, seed.bytes, seed.name);
  }
}

TEST(DicomMutants, SayWhatTheirBytesSayOrAreRefused) { run_mutants(300, 1); }
TEST(LongDicomMutants, TenThousand) { run_mutants(10000, 100000); }

// A tag that matters and stands twice leaves it to chance which is meant.
TEST(DicomMutants, ATagGivenTwiceIsRefused) {
  for (const std::uint32_t t : {tag(0x28, 0x1052), tag(0x28, 0x30), tag(0x28, 0x11), tag(0x20, 0x32)}) {
    const DataSet d = scan().slice(0);
    const std::string whole = synthetic::file_bytes(d);
    const std::string element = d.bytes(true, t, t);
    std::string bytes = whole;
    bytes.insert(bytes.find(element), element);
    const dicom::FileHeader h = dicom::read_header(dicom::Origin::memory(bytes));
    ASSERT_FALSE(h.faults.empty());
    EXPECT_EQ(h.faults.front().tag, t);
    EXPECT_NE(h.faults.front().what.find("twice"), std::string::npos);
  }
}

}  // namespace
}  // namespace trephine
