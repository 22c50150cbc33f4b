// SPDX-License-Identifier: GPL-3.0-or-later
// GDCM writes into memory; our own writer puts the bytes on the disk.
#include "phantom/series.h"

#include <fmt/format.h>

#include <cmath>

#include "base/degree.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "codecs/codecs.h"
#include "codecs/element_text.h"

namespace trephine::phantom {
namespace {

struct VR {
  // NOLINTBEGIN(readability-identifier-naming): as DICOM spells them
  static constexpr const char *CS = "CS", *DA = "DA", *DS = "DS", *IS = "IS", *LO = "LO", *PN = "PN", *SH = "SH",
                              *SS = "SS", *TM = "TM", *UI = "UI", *US = "US";
  // NOLINTEND(readability-identifier-naming)
};

using codecs::decimal, codecs::decimals;

std::string uid(const std::string& identity, const char* what, int number) {
  return codecs::uid_of_hash(Sha256().text("trephine phantom").text(identity).text(what).integer(number).hex());
}

class Attributes {
 public:
  void text(std::uint16_t group, std::uint16_t element, const char* vr, std::string value) {
    if (value.size() % 2) value += vr == VR::UI ? '\0' : ' ';
    elements_.push_back({group, element, vr, std::move(value)});
  }
  void word(std::uint16_t group, std::uint16_t element, int value, const char* vr = VR::US) {
    elements_.push_back(
        {group, element, vr, {static_cast<char>(value & 0xff), static_cast<char>((value >> 8) & 0xff)}});
  }
  const std::vector<codecs::FileElement>& elements() const { return elements_; }

 private:
  std::vector<codecs::FileElement> elements_;
};

struct Storage {
  int bits_stored, representation;
  long low, high;
};
Storage storage_of(Pixels pixels) {
  switch (pixels) {
    case Pixels::unsigned_12:
      return {12, 0, 0, 4095};
    case Pixels::unsigned_16:
      return {16, 0, 0, 65535};
    case Pixels::signed_16:
      break;
  }
  return {16, 1, -32768, 32767};
}

long stored_padding(const SeriesParams& p, const Storage& s) {
  return std::max(s.low, padding_hu - static_cast<long>(p.intercept_hu));
}

std::vector<char> stored_pixels(const Scan& scan, int slice, const SeriesParams& params, const Storage& storage) {
  const std::size_t count = static_cast<std::size_t>(scan.columns) * scan.rows;
  const std::int16_t* hu = &scan.hu[count * slice];
  std::vector<char> bytes(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const long v = scan.padded && hu[i] == padding_hu ? stored_padding(params, storage)
                                                      : hu[i] - static_cast<long>(params.intercept_hu);
    if (v < storage.low || v > storage.high)
      throw Error(ExitCode::usage, "", "intercept_hu",
                  fmt::format("{}: {} HU does not fit the stored pixels", params.intercept_hu, hu[i]));
    bytes[2 * i] = static_cast<char>(v & 0xff);
    bytes[2 * i + 1] = static_cast<char>((v >> 8) & 0xff);
  }
  return bytes;
}

const char* syntax_of(Encoding e) {
  switch (e) {
    case Encoding::none:
      break;
    case Encoding::rle:
      return "1.2.840.10008.1.2.5";
    case Encoding::jpeg_ls:
      return "1.2.840.10008.1.2.4.80";
    case Encoding::jpeg_2000:
      return "1.2.840.10008.1.2.4.90";
  }
  return "1.2.840.10008.1.2.1";
}

const char* position_code(Position p) {
  switch (p) {
    case Position::head_first_supine:
      return "HFS";
    case Position::head_first_prone:
      return "HFP";
    case Position::feet_first_supine:
      return "FFS";
    case Position::feet_first_prone:
      return "FFP";
  }
  return "HFS";
}

void describe_patient_and_series(Attributes& a, const std::string& identity, const ScanParams& p,
                                 const SeriesNames& names) {
  a.text(0x0008, 0x0005, VR::CS, "ISO_IR 100");
  a.text(0x0008, 0x0008, VR::CS,
         p.plane == Plane::axial ? "ORIGINAL\\PRIMARY\\AXIAL" : "DERIVED\\SECONDARY\\REFORMATTED");
  a.text(0x0008, 0x0016, VR::UI, "1.2.840.10008.5.1.4.1.1.2");
  for (const int element : {0x0020, 0x0021, 0x0022, 0x0023}) a.text(0x0008, element, VR::DA, "20000101");
  for (const int element : {0x0030, 0x0031, 0x0032, 0x0033}) a.text(0x0008, element, VR::TM, "120000");
  a.text(0x0008, 0x0050, VR::SH, "");
  a.text(0x0008, 0x0060, VR::CS, "CT");
  a.text(0x0008, 0x0070, VR::LO, "Trephine");
  a.text(0x0008, 0x0090, VR::PN, "");
  a.text(0x0008, 0x103e, VR::LO, "Synthetic head");
  a.text(0x0008, 0x1090, VR::LO, "phantom");
  a.text(0x0010, 0x0010, VR::PN, "TREPHINE^PHANTOM");
  a.text(0x0010, 0x0020, VR::LO, "PHANTOM");
  a.text(0x0010, 0x0030, VR::DA, "");
  a.text(0x0010, 0x0040, VR::CS, "O");
  a.text(0x0012, 0x0062, VR::CS, "YES");
  a.text(0x0012, 0x0063, VR::LO, "Synthetic: no patient");
  a.text(0x0018, 0x0050, VR::DS, decimal(p.slice_thickness_mm));
  a.text(0x0018, 0x0060, VR::DS, "120");
  a.text(0x0018, 0x0088, VR::DS, decimal(p.slice_step_mm * std::cos(p.tilt_deg * degree)));
  a.text(0x0018, 0x1120, VR::DS, decimal(p.tilt_deg));
  a.text(0x0018, 0x1210, VR::SH, "GAUSS" + decimal(p.kernel_mm));
  a.text(0x0018, 0x5100, VR::CS, position_code(p.position));
  a.text(0x0020, 0x000d, VR::UI, uid(identity, "study", 0));
  a.text(0x0020, 0x000e, VR::UI, uid(identity, "series", names.number - 1));
  a.text(0x0020, 0x0010, VR::SH, "1");
  a.text(0x0020, 0x0011, VR::IS, std::to_string(names.number));
  a.text(0x0020, 0x0012, VR::IS, "1");
  a.text(0x0020, 0x0052, VR::UI, uid(identity, "frame", 0));
  a.text(0x0020, 0x1040, VR::LO, "");
}

void describe_slice(Attributes& a, const std::string& identity, const Scan& scan, int slice, const SeriesParams& params,
                    const SeriesNames& names) {
  const SlicePose& s = scan.slices[slice];
  const Storage storage = storage_of(params.pixels);
  a.text(0x0008, 0x0018, VR::UI, uid(identity, names.number == 1 ? "instance" : "instance of a further series", slice));
  a.text(0x0020, 0x0013, VR::IS, std::to_string(slice + 1));
  a.text(0x0020, 0x0032, VR::DS, decimals({s.origin_mm.x, s.origin_mm.y, s.origin_mm.z}));
  a.text(0x0020, 0x0037, VR::DS, decimals({s.row.x, s.row.y, s.row.z, s.column.x, s.column.y, s.column.z}));
  a.text(0x0020, 0x1041, VR::DS, decimal(dot(s.origin_mm, normalized(cross(s.row, s.column)))));
  a.word(0x0028, 0x0002, 1);
  a.text(0x0028, 0x0004, VR::CS, "MONOCHROME2");
  a.word(0x0028, 0x0010, scan.rows);
  a.word(0x0028, 0x0011, scan.columns);
  a.text(0x0028, 0x0030, VR::DS, decimals({scan.pixel_mm, scan.pixel_mm}));
  a.word(0x0028, 0x0100, 16);
  a.word(0x0028, 0x0101, storage.bits_stored);
  a.word(0x0028, 0x0102, storage.bits_stored - 1);
  a.word(0x0028, 0x0103, storage.representation);
  if (scan.padded)
    a.word(0x0028, 0x0120, static_cast<int>(stored_padding(params, storage)), storage.representation ? VR::SS : VR::US);
  a.text(0x0028, 0x1050, VR::DS, "40");
  a.text(0x0028, 0x1051, VR::DS, "100");
  a.text(0x0028, 0x1052, VR::DS, std::to_string(params.intercept_hu));
  a.text(0x0028, 0x1053, VR::DS, "1");
  a.text(0x0028, 0x1054, VR::LO, "HU");
}

std::filesystem::path slice_file(const std::filesystem::path& folder, const SeriesNames& names, std::size_t number) {
  return folder / fmt::format("{}_{:04}.dcm", names.file, number);
}

void remove_longer_series(const std::filesystem::path& folder, const SeriesNames& names, std::size_t slices) {
  std::error_code ignored;
  for (std::size_t k = slices + 1; std::filesystem::remove(slice_file(folder, names, k), ignored); ++k) {
  }
}

}  // namespace

void remove_series(const std::filesystem::path& folder, const SeriesNames& names) {
  remove_longer_series(folder, names, 0);
}

std::uint64_t write_series(const std::filesystem::path& folder, const Scan& scan, const ScanParams& scan_params,
                           const SeriesParams& params, const std::string& identity, const Progress& progress,
                           const SeriesNames& names) {
  make_output_folder(folder);
  const Storage storage = storage_of(params.pixels);
  std::uint64_t total = 0;
  for (int k = 0; k < static_cast<int>(scan.slices.size()); ++k) {
    progress.report(k / static_cast<double>(scan.slices.size()));
    Attributes attributes;
    describe_patient_and_series(attributes, identity, scan_params, names);
    describe_slice(attributes, identity, scan, k, params, names);
    const std::vector<char> pixels = stored_pixels(scan, k, params, storage);
    const codecs::CodedFrame frame{syntax_of(params.encoding), scan.columns, scan.rows, 16, storage.bits_stored,
                                   storage.representation == 1};
    std::string bytes, fault;
    if (!codecs::codecs().write(&attributes.elements(), &frame, &pixels, &bytes, &fault))
      throw Error(ExitCode::internal, "", "dicom", fmt::format("slice {}: {}", k + 1, fault));
    write_file(slice_file(folder, names, static_cast<std::size_t>(k) + 1), bytes);
    total += bytes.size();
  }
  remove_longer_series(folder, names, scan.slices.size());
  return total;
}

}  // namespace trephine::phantom
