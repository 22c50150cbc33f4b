// SPDX-License-Identifier: GPL-3.0-or-later
// Series in ZIP archives and on discs as they come from the hospital, and archives that mean harm.
#include "dicom/archive.h"

#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "dicom/import.h"
#include "dicom_synthetic.h"
#include "zip_writer.h"

namespace trephine {
namespace {

using synthetic::Scan;
using synthetic::zip_bytes;
using synthetic::ZipMember;

Scan scan() {
  Scan s;
  s.columns = 31;
  s.rows = 27;
  s.slices = 9;
  s.background_hu = 30;
  s.blobs = synthetic::four_blobs(10, 4);
  return s;
}

std::vector<ZipMember> members_of(const Scan& s, const std::string& folder = "EXPORT/DICOM/") {
  std::vector<ZipMember> all;
  for (int k = 0; k < s.count(); ++k)
    all.push_back({folder + "IM" + std::to_string(100 + k), synthetic::file_bytes(s.slice(k), s.syntax)});
  return all;
}

/// A file of media directory class, as on every disc.
std::string dicomdir() {
  synthetic::DataSet meta;
  meta.text(synthetic::tag(2, 0x02), "UI", "1.2.840.10008.1.3.10");
  meta.text(synthetic::tag(2, 0x10), "UI", "1.2.840.10008.1.2.1");
  synthetic::DataSet d;
  d.text(synthetic::tag(4, 0x1130), "CS", "CANARY DISC");
  return std::string(128, '\0') + "DICM" + meta.bytes() + d.bytes();
}

std::string refusal_of(const std::vector<ZipMember>& members, ExitCode expected = ExitCode::bad_input) {
  const ScratchFolder folder;
  const auto file = folder.write("a.zip", zip_bytes(members));
  try {
    dicom::import_series(file, {});
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), expected) << e.line("");
    EXPECT_EQ(e.file().rfind("scan (", 0), 0u) << e.file();
    EXPECT_EQ(e.field(), "archive");
    return e.what();
  }
  return "no error";
}

// As in a folder: a slice at the end that has lost its beginning, or everything, is told of.
TEST(DicomArchive, ASliceAtTheEndThatVanishesIsToldOf) {
  const auto warnings = [](const std::function<std::string(std::string)>& change) {
    const ScratchFolder folder;
    auto members = members_of(scan());
    members.back().bytes = change(members.back().bytes);
    members.push_back({"EXPORT/READ.ME", "nothing of a slice"});
    std::string all;
    for (const Warning& w : dicom::import_series(folder.write("a.zip", zip_bytes(members)), {}).folder.warnings)
      all += to_text(w);
    return all;
  };
  EXPECT_EQ(warnings([](std::string b) { return b; }), "");
  const std::string headless = warnings([](std::string b) { return std::string(400, 'x') + b.substr(300); });
  EXPECT_NE(headless.find("file 9 of 10 (by name) is DICOM and was left out"), std::string::npos) << headless;
  const std::string empty = warnings([](const std::string&) { return std::string(); });
  EXPECT_NE(empty.find("1 empty file, the first is number 9"), std::string::npos) << empty;
}

TEST(DicomArchive, GivesTheSameVolumeAndHashAsTheFolder) {
  for (const bool deflate : {true, false}) {
    const Scan s = scan();
    const ScratchFolder folder, disc;
    s.write(folder);
    auto members = members_of(s);
    for (auto& m : members) m.deflate = deflate;
    std::swap(members[2], members[7]);
    members.insert(members.begin(), {"EXPORT/", "", false, 0, 040755});
    members.push_back({"DICOMDIR", dicomdir()});
    members.push_back({"EXPORT/viewer.exe", "MZ and more"});
    members.push_back({"__MACOSX/._IM100", "hidden"});
    members.push_back({"EXPORT/Current", "target", false, 0, 0120777});
    members.push_back({"inner.zip", zip_bytes(members_of(s))});  // not opened: its slices would be doubles
    members.push_back({"empty", "", false});
    const auto file = disc.write("export.zip", zip_bytes(members));
    const dicom::ImportResult a = dicom::import_series(folder.path(), {}), b = dicom::import_series(file, {});
    EXPECT_TRUE(synthetic::same_volume(a.volume, b.volume));
    EXPECT_EQ(a.input_sha256, b.input_sha256);
    EXPECT_EQ(dicom::hash_of_series_input(file, {}), a.input_sha256);
    EXPECT_EQ(std::get<std::int64_t>(*b.report().find("duplicates_dropped_count")), 0);
    EXPECT_EQ(std::get<std::int64_t>(*printed(b.folder).find("skipped_hidden_count")), 1);
    EXPECT_EQ(std::get<std::int64_t>(*printed(b.folder).find("skipped_links_count")), 1);
    EXPECT_EQ(std::get<std::int64_t>(*printed(b.folder).find("skipped_not_dicom_count")), 4);
    const dicom::SeriesList list = dicom::list_series(file);
    ASSERT_EQ(list.series.size(), 1u);
    EXPECT_EQ(list.series[0].verdict, "usable");
    EXPECT_EQ(list.series[0].token, dicom::list_series(folder.path()).series[0].token);
  }
}

TEST(DicomArchive, ADiscWithItsDirectoryIsAFolderLikeAnyOther) {
  const Scan s = scan();
  const ScratchFolder plain, disc;
  s.write(plain);
  disc.write("DICOMDIR", dicomdir());
  disc.write("AUTORUN.INF", "[autorun]");
  s.write(disc, [](int k) { return "DICOM/PA000001/ST000001/SE000001/IM" + std::to_string(k); });
  const dicom::ImportResult a = dicom::import_series(plain.path(), {}), b = dicom::import_series(disc.path(), {});
  EXPECT_TRUE(synthetic::same_volume(a.volume, b.volume));
  EXPECT_EQ(a.input_sha256, b.input_sha256);
  try {
    dicom::import_series(disc.path() / "DICOMDIR", {});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(e.what()).find("DICOMDIR"), std::string::npos) << e.what();
  }
}

// A compressed slice goes to the decoding child without a file.
TEST(DicomArchive, CompressedSlicesToo) {
  const Scan s = scan();
  Scan compressed = s;
  compressed.syntax = "1.2.840.10008.1.2.5";
  compressed.edit = [](int, synthetic::DataSet& d) {
    auto& pixels = d.elements[synthetic::tag(0x7fe0, 0x0010)];
    pixels = synthetic::encapsulated(synthetic::rle_stream(pixels.bytes));
  };
  const ScratchFolder raw, packed;
  s.write(raw);
  const auto file = packed.write("a.zip", zip_bytes(members_of(compressed)));
  const dicom::ImportResult a = dicom::import_series(raw.path(), {}), b = dicom::import_series(file, {});
  EXPECT_EQ(std::get<std::string>(*b.report().find("transfer_syntax")), "RLE lossless");
  EXPECT_TRUE(synthetic::same_volume(a.volume, b.volume));
}

TEST(DicomArchive, NamesLeadNowhere) {
  for (const char* name : {"../../etc/passwd", "/etc/passwd", "a/../../b", "..\\b", "C:\\b", "a/.."}) {
    auto members = members_of(scan());
    members.push_back({name, "x"});
    EXPECT_NE(refusal_of(members).find("leads out"), std::string::npos) << name;
  }
}

TEST(DicomArchive, EncryptedOnesAreRefused) {
  auto members = members_of(scan());
  members[4].flags = 1;
  EXPECT_NE(refusal_of(members).find("encrypted"), std::string::npos);
}

TEST(DicomArchive, DamageIsTold) {
  const auto good = members_of(scan());
  auto bad = good;
  bad[3].checksum = 12345;
  EXPECT_NE(refusal_of(bad).find("damaged"), std::string::npos);
  for (const std::int64_t claimed : {std::int64_t{100}, std::int64_t(good[3].bytes.size() - 1),
                                     std::int64_t(good[3].bytes.size() + 1), std::int64_t{0xfffffffe}}) {
    bad = good;
    bad[3].size = claimed;
    EXPECT_NE(refusal_of(bad), "no error") << claimed;
  }
  bad = good;
  bad[3].method = 9;
  EXPECT_NE(refusal_of(bad).find("method 9"), std::string::npos) << refusal_of(bad);
  // Cut anywhere, or with any byte of its directory changed, it is refused or gives the same volume; nothing dies.
  const ScratchFolder folder;
  const std::string whole = zip_bytes(good);
  const dicom::ImportResult truth = dicom::import_series(folder.write("good.zip", whole), {});
  int refused = 0;
  for (int n = 0; n < 60; ++n) {
    std::string bytes = whole;
    if (n < 20)
      bytes.resize(bytes.size() * static_cast<std::size_t>(n) / 20);
    else
      bytes[bytes.size() - 1 - static_cast<std::size_t>((n - 20) * 13)] ^= static_cast<char>(1 << (n % 8));
    try {
      const dicom::ImportResult r = dicom::import_series(folder.write("bad.zip", bytes), {});
      EXPECT_TRUE(synthetic::same_volume(r.volume, truth.volume)) << n;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input) << n << e.line("");
      ++refused;
    }
  }
  EXPECT_GT(refused, 30);
}

dicom::ArchiveLimits small_limits() {
  dicom::ArchiveLimits l;
  l.members = 50;
  l.member_bytes = 1 << 20;
  l.bytes = 4 << 20;
  l.free_of_ratio = 1 << 16;
  return l;
}

TEST(DicomArchive, BombsAreRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::vector<ZipMember>& members) -> std::string {
    try {
      dicom::read_archive(folder.write("bomb.zip", zip_bytes(members)), {}, small_limits());
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.what();
    }
    return "no error";
  };
  const std::string head = std::string(128, '\0') + "DICM";
  std::string noise(900 << 10, '\0');
  std::uint32_t state = 1;
  for (char& c : noise) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  EXPECT_EQ(refusal({{"a", head + noise}}), "no error");
  EXPECT_NE(refusal({{"a", head + noise + noise}}).find("at most 1048576"), std::string::npos);
  EXPECT_NE(refusal(std::vector<ZipMember>(5, {"a", head + noise})).find("more than 4194304"), std::string::npos);
  EXPECT_NE(refusal({{"a", head + std::string(900 << 10, '\0')}}).find("200 times"), std::string::npos);
  EXPECT_NE(refusal(std::vector<ZipMember>(51, {"a", "x"})).find("51 members"), std::string::npos);
  // Every member the same data, as Fifield's: the ratio tells.
  std::vector<ZipMember> overlapping(50, {"a", head + std::string(90 << 10, 'x')});
  for (std::size_t i = 1; i < overlapping.size(); ++i) overlapping[i].same_data_as = 0;
  EXPECT_NE(refusal(overlapping), "no error");
  // What is no DICOM is not inflated at all.
  EXPECT_EQ(refusal({{"a", std::string(8 << 20, '\0')}, {"b", head}}), "no error");
}

// The usual limits, on a bomb of 1 GB in 1 MB: refused before much of it is there, the memory given back.
TEST(DicomArchive, ABombCostsLittle) {
  std::string part = std::string(128, '\0') + "DICM" + std::string((100 << 20) - 132, '\0');
  std::vector<ZipMember> members(10);
  for (int i = 0; i < 10; ++i) members[static_cast<std::size_t>(i)].name = "IM" + std::to_string(i);
  members[0].bytes = std::move(part);
  for (int i = 1; i < 10; ++i) {
    members[static_cast<std::size_t>(i)].same_data_as = 0;
    members[static_cast<std::size_t>(i)].size = 100 << 20;
    members[static_cast<std::size_t>(i)].checksum = 0;
  }
  EXPECT_NE(refusal_of(members).find("200 times"), std::string::npos);
}

TEST(DicomArchive, WithoutDicomSaysSo) {
  const ScratchFolder folder;
  try {
    dicom::import_series(folder.write("a.zip", zip_bytes({{"a.txt", "hello"}, {"b.txt", "you"}})), {});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
  }
  EXPECT_THROW(dicom::import_series(folder.write("b.zip", zip_bytes({})), {}), Error);
}

}  // namespace
}  // namespace trephine
