// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/object_reader.h"

#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "dicom/values.h"
#include "itk/volume_write.h"
#include "pacs/tags.h"

namespace trephine::pacs {

using dicom::Element;
using dicom::Level;

void refuse(const std::string& field, const std::string& what) { throw Error(ExitCode::bad_input, "", field, what); }

namespace {

// Of data of contours it may be long.
std::string value_of(dicom::ByteSource& source, const Element& e) {
  constexpr std::uint32_t most = 64u << 20;
  if (e.length > most) refuse(dicom::tag_name(e.tag), fmt::format("{} bytes, at most {} make sense", e.length, most));
  std::string value(e.length, '\0');
  if (!source.read(e.offset, value.data(), value.size())) refuse(dicom::tag_name(e.tag), "is cut short");
  return value;
}
}  // namespace

std::string text_of(dicom::ByteSource& source, const Element& e) {
  const std::string value = value_of(source, e);
  return std::string(dicom::trimmed(value));
}
std::vector<double> numbers_of(dicom::ByteSource& source, const Element& e) {
  const auto numbers = dicom::parse_decimals(value_of(source, e));
  if (!numbers) refuse(dicom::tag_name(e.tag), "is not decimal numbers");
  return *numbers;
}
int word_of(dicom::ByteSource& source, const Element& e) {
  const std::string value = value_of(source, e);
  if (value.size() < 2) refuse(dicom::tag_name(e.tag), "is missing");
  return dicom::le16(reinterpret_cast<const std::uint8_t*>(value.data()));
}
Vec3 vector_of(const std::vector<double>& v, std::size_t at, std::uint32_t tag) {
  if (v.size() < at + 3) refuse(dicom::tag_name(tag), "has too few numbers");
  return {v[at], v[at + 1], v[at + 2]};
}

// Its first element says how long the file meta information is (PS3.10 7.1).
DataSet data_set_of(dicom::ByteSource& source) {
  const std::uint8_t* p = source.get(128, 16);
  if (!p || std::memcmp(p, "DICM", 4) != 0 || dicom::le16(p + 4) != 2 || dicom::le16(p + 6) != 0)
    refuse("", "not a DICOM file");
  DataSet out;
  out.begin = 144 + std::uint64_t{dicom::le32(p + 12)};
  if (out.begin > source.size()) refuse("", "file meta information is cut short");
  std::string syntax;
  dicom::walk_elements(
      source, 132, out.begin, true, [](std::uint32_t) { return false; },
      [&](const Element& e, const std::vector<Level>&) {
        if (e.tag == 0x00020010) syntax = text_of(source, e);
      });
  const dicom::TransferSyntax* known = dicom::find_transfer_syntax(syntax);
  if (!known || known->encoding != dicom::Encoding::native)
    refuse("TransferSyntaxUID (0002,0010)", "must be uncompressed little endian: save the object uncompressed");
  out.explicit_vr = known->explicit_vr;
  return out;
}

LabelObject decode_label_object(const dicom::Origin& origin) {
  try {
    dicom::ByteSource source(origin);
    const DataSet set = data_set_of(source);
    std::string sop_class;
    dicom::walk_elements(
        source, set.begin, source.size(), set.explicit_vr, [](std::uint32_t) { return false; },
        [&](const Element& e, const std::vector<Level>& levels) {
          if (levels.empty() && e.tag == t_sop_class) sop_class = text_of(source, e);
        });
    if (sop_class == class_seg) return segmentation_of(source, set);
    if (sop_class == class_rtss) return structure_set_of(source, set);
    refuse("SOPClassUID (0008,0016)", "must be a segmentation (SEG) or an RT structure set");
  } catch (const dicom::WalkFault& f) {
    refuse(f.field, f.what);
  }
}

grid::LabelFile read_label_file(const std::filesystem::path& file, const Progress& progress) {
  try {
    dicom::ByteSource source{dicom::Origin(file)};
    const std::uint8_t* p = source.get(128, 4);
    if (!p || std::memcmp(p, "DICM", 4) != 0) return itk::read_label_file(file, progress);
  } catch (const std::system_error&) {  // it is not there, or is no file: said by the other reader
    return itk::read_label_file(file, progress);
  }
  return with_file(file.string(), [&] { return label_file_of(decode_label_object(dicom::Origin(file)), progress); });
}

}  // namespace trephine::pacs
