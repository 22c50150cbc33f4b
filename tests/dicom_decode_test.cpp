// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed pixel data through the bounded child: the same bytes as uncompressed, and damage is told, never filled up
// (D8).
#include "dicom/decode.h"

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gtest/gtest.h>

#include <fstream>
#include <ostream>
#include <sstream>

#include "base/error.h"
#include "dicom/import.h"
#include "dicom_synthetic.h"

namespace trephine {
namespace {

using synthetic::Scan;

struct Syntax {
  const char* name;
  gdcm::TransferSyntax::TSType type;
};
void PrintTo(const Syntax& v, std::ostream* out) { *out << v.name; }

Scan scan_for(bool is_signed, int bits) {
  Scan s;
  s.columns = 37;  // odd, so that rows and strides are not confused
  s.rows = 29;
  s.slices = 7;
  s.is_signed = is_signed;
  s.bits_stored = bits;
  s.intercept = is_signed ? 0 : -1024;
  s.background_hu = is_signed ? -300 : 0;
  s.blobs = synthetic::four_blobs(10, 5);
  // GDCM writes US, unspecified, where there is none.
  s.edit = [](int, synthetic::DataSet& d) { d.text(synthetic::tag(0x28, 0x1054), "LO", "HU"); };
  // Noise over the whole range but the values that GDCM's encoder is known to need: none.
  s.stored = [s](int i, int j, int k) -> std::optional<std::int64_t> {
    if ((i * 31 + j * 17 + k * 7) % 5 != 0) return std::nullopt;
    const std::int64_t range = std::int64_t{1} << s.bits_stored, v = (i * 7919 + j * 104729 + k * 1299709) % range;
    return s.is_signed ? v - range / 2 : v;
  };
  return s;
}

void compress(const std::filesystem::path& folder, gdcm::TransferSyntax::TSType type) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    gdcm::ImageReader reader;
    reader.SetFileName(entry.path().c_str());
    ASSERT_TRUE(reader.Read());
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(type);
    change.SetInput(reader.GetImage());
    ASSERT_TRUE(change.Change());
    gdcm::ImageWriter writer;
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    const std::string out = entry.path().string() + ".c";
    writer.SetFileName(out.c_str());
    ASSERT_TRUE(writer.Write());
    std::filesystem::rename(out, entry.path());
  }
}

class Compressed : public testing::TestWithParam<Syntax> {};

TEST_P(Compressed, DecodesToTheSameVolume) {
  for (const bool is_signed : {false, true})
    for (const int bits : {12, 16}) {
      const Scan s = scan_for(is_signed, bits);
      const ScratchFolder raw, packed;
      s.write(raw);
      s.write(packed);
      compress(packed.path(), GetParam().type);
      const dicom::ImportResult a = dicom::import_series(raw.path(), {}), b = dicom::import_series(packed.path(), {});
      EXPECT_TRUE(synthetic::same_volume(a.volume, b.volume)) << (is_signed ? "signed " : "unsigned ") << bits;
      EXPECT_EQ(std::get<std::string>(*b.report().find("transfer_syntax")), GetParam().name);
    }
}

std::string slurp(const std::filesystem::path& p) {
  std::ifstream in(p, std::ios::binary);
  std::ostringstream s;
  s << in.rdbuf();
  return s.str();
}

TEST_P(Compressed, DamageIsTold) {
  const Scan s = scan_for(false, 12);
  const ScratchFolder folder;
  s.write(folder);
  compress(folder.path(), GetParam().type);
  const auto file = folder.path() / "slice1003.dcm";
  const std::string good = slurp(file);
  const std::string marker = std::string("\xe0\x7f\x10\x00", 4);
  const std::size_t stream = good.find(marker) + 12 + 16;  // behind the empty offset table and the item's head
  ASSERT_LT(stream, good.size());
  std::vector<std::string> bad;
  bad.push_back(good.substr(0, good.size() - 1));
  bad.push_back(good.substr(0, (stream + good.size()) / 2));
  std::string b = good;
  for (std::size_t i = stream; i < b.size() - 8; ++i)
    b[i] = static_cast<char>(i * 151 + 17);  // garbage of the right length
  bad.push_back(b);
  b = good;
  for (std::size_t i = (stream + b.size()) / 2; i < b.size() - 8; ++i)
    b[i] = 0;  // the second half gone, the length kept
  bad.push_back(b);
  for (const std::string& bytes : bad) {
    folder.write("slice1003.dcm", bytes);
    try {
      dicom::import_series(folder.path(), {});
      ADD_FAILURE() << "damage number " << (&bytes - bad.data()) << " was read";
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal) << e.line("import");
      EXPECT_EQ(e.file().rfind("scan: file 4 of ", 0), 0u) << e.line("import");
    }
  }
}

TEST_P(Compressed, AnotherSizeThanTheHeaderSays) {
  Scan s = scan_for(false, 12);
  const ScratchFolder folder, other;
  s.write(folder);
  compress(folder.path(), GetParam().type);
  // The same stream under a header of other rows.
  std::string bytes = slurp(folder.path() / "slice1003.dcm");
  const std::size_t rows = bytes.find(std::string("\x28\x00\x10\x00US\x02\x00", 8));
  ASSERT_NE(rows, std::string::npos);
  bytes[rows + 8] = 31;
  const auto file = other.write("a.dcm", bytes);
  const dicom::FileHeader h = [&] {
    dicom::FileHeader read = dicom::read_header(file);
    read.name = "a.dcm";
    return read;
  }();
  ASSERT_TRUE(h.faults.empty());
  try {
    dicom::read_frames({{&h, 0}}, [](std::size_t, const std::uint8_t*) { ADD_FAILURE(); });
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input) << e.line("");
    EXPECT_EQ(e.file(), "a.dcm");
  }
}

INSTANTIATE_TEST_SUITE_P(D8, Compressed,
                         testing::Values(Syntax{"RLE lossless", gdcm::TransferSyntax::RLELossless},
                                         Syntax{"JPEG lossless first order",
                                                gdcm::TransferSyntax::JPEGLosslessProcess14_1},
                                         Syntax{"JPEG-LS lossless", gdcm::TransferSyntax::JPEGLSLossless},
                                         Syntax{"JPEG 2000 lossless", gdcm::TransferSyntax::JPEG2000Lossless}),
                         [](const auto& i) {
                           std::string s = i.param.name;
                           for (char& c : s)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return s;
                         });

}  // namespace
}  // namespace trephine
