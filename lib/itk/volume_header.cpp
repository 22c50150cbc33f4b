// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/volume_header.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "grid/gzip_limit.h"
#include "grid/nrrd_header.h"
#include "grid/nrrd_scale.h"
#include "itk/header_numbers.h"

namespace trephine::itk {
namespace fs = std::filesystem;

namespace {

using Keys = std::map<std::string, std::string>;

using detail::bad;

std::vector<double> numbers(const std::string& key, const std::string& text, std::size_t count) {
  std::vector<double> found = detail::numbers_of(key, text);
  if (found.size() != count) bad(key, "must hold " + std::to_string(count) + " numbers");
  return found;
}

// A plain name, so that a header cannot have another file read.
fs::path beside(const fs::path& file, const std::string& key, const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos || name.find('\\') != std::string::npos || name == ".." ||
      name.find('%') != std::string::npos || name.find(' ') != std::string::npos || name == "LIST")
    bad(key, "must name one file beside the header");
  const fs::path data = file.parent_path() / name;
  std::error_code none;
  if (!fs::is_regular_file(data, none))
    throw Error(ExitCode::no_input, "", key, "the data file is not beside the header");
  return data;
}

const std::string& one_of(const Keys& keys, std::initializer_list<const char*> names) {
  const std::string* found = nullptr;
  for (const char* name : names) {
    const auto at = keys.find(name);
    if (at == keys.end()) continue;
    if (found && *found != at->second) bad(name, "contradicts another key of the same meaning");
    found = &at->second;
  }
  if (!found) bad(*names.begin(), "is missing: the file does not say where it lies");
  return *found;
}

int bytes_of_meta_type(const std::string& type) {
  static const std::pair<const char*, int> types[] = {{"MET_CHAR", 1},   {"MET_UCHAR", 1}, {"MET_SHORT", 2},
                                                      {"MET_USHORT", 2}, {"MET_INT", 4},   {"MET_UINT", 4},
                                                      {"MET_FLOAT", 4},  {"MET_DOUBLE", 8}};
  for (const auto& [name, bytes] : types)
    if (type == name) return bytes;
  bad("ElementType", "is none of 8, 16 and 32 bits, float and double");
}

// True or False and nothing else: a reader that takes another word for one of them swaps bytes or reads numbers as
// text.
bool is_true(const Keys& keys, const char* key) {
  const auto at = keys.find(key);
  if (at == keys.end()) bad(key, "is missing");
  if (at->second != "True" && at->second != "False") bad(key, "must be True or False");
  return at->second == "True";
}

// What a MetaImage may say without a change of its voxels or their place: names, comments, colours, display.
bool is_meaningless(const std::string& key) {
  static const std::set<std::string> keys = {"ObjectSubType",
                                             "TransformType",
                                             "Name",
                                             "ID",
                                             "ParentID",
                                             "Comment",
                                             "Color",
                                             "SequenceID",
                                             "AnatomicalOrientation",
                                             "ElementMin",
                                             "ElementMax",
                                             "CompressionLevel",
                                             "ElementSize",
                                             "AcquisitionDate"};
  return keys.count(key) > 0;
}
bool is_read(const std::string& key) {
  static const std::set<std::string> keys = {"ObjectType",
                                             "NDims",
                                             "BinaryData",
                                             "BinaryDataByteOrderMSB",
                                             "ElementByteOrderMSB",
                                             "CompressedData",
                                             "CompressedDataSize",
                                             "DimSize",
                                             "ElementSpacing",
                                             "Offset",
                                             "Position",
                                             "Origin",
                                             "TransformMatrix",
                                             "Rotation",
                                             "Orientation",
                                             "CenterOfRotation",
                                             "DistanceUnits",
                                             "Modality",
                                             "HeaderSize",
                                             "ElementNumberOfChannels",
                                             "ElementToIntensityFunctionSlope",
                                             "ElementToIntensityFunctionOffset",
                                             "ElementType",
                                             "ElementDataFile"};
  return keys.count(key) > 0;
}

// Keys that ITK passes over, though they change what the voxels or their places mean.
void require_plain_meaning(const Keys& keys) {
  const auto must_be = [&](const char* key, std::initializer_list<double> wanted, const char* what) {
    const auto at = keys.find(key);
    if (at == keys.end()) return;
    if (numbers(key, at->second, wanted.size()) != std::vector<double>(wanted)) bad(key, what);
  };
  must_be("ElementToIntensityFunctionSlope", {1}, "must be 1: convert the file to one whose values are what is meant");
  must_be("ElementToIntensityFunctionOffset", {0}, "must be 0: convert the file to one whose values are what is meant");
  must_be("CenterOfRotation", {0, 0, 0}, "must be 0: the file's place would be another than its Offset says");
  if (const auto at = keys.find("DistanceUnits");
      at != keys.end() && at->second != "mm" && at->second != "MET_DISTANCE_UNITS_MM" && at->second != "?")
    bad("DistanceUnits", "must be mm");
  if (const auto at = keys.find("ObjectType"); at != keys.end() && at->second != "Image")
    bad("ObjectType", "must be Image");
  const auto order = keys.find("ElementByteOrderMSB"), other = keys.find("BinaryDataByteOrderMSB");
  if (order != keys.end() && other != keys.end() && order->second != other->second)
    bad("ElementByteOrderMSB", "contradicts BinaryDataByteOrderMSB");
}

// "MR" of MET_MOD_MR; empty where the file leaves it open.
std::string modality_of(const Keys& keys) {
  const auto at = keys.find("Modality");
  if (at == keys.end() || at->second == "MET_MOD_UNKNOWN" || at->second == "MET_MOD_OTHER") return "";
  for (const char* known : {"CT", "MR", "NM", "US", "PET"})
    if (at->second == std::string("MET_MOD_") + known) return known;
  bad("Modality", "is none that is known");
}

}  // namespace

std::string head_of(const fs::path& file) {
  std::string text(std::size_t{1} << 16, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

void VolumeHeader::require_same(const ItkVolume& itk) const {
  if (!said) return;
  const auto near = [](double a, double b) { return std::fabs(a - b) <= 1e-6 * (1 + std::fabs(a)); };
  bool same = itk.size == said->size;
  for (std::size_t a = 0; a < 3; ++a) {
    same = same && near(said->spacing[a], itk.spacing[a]) && near(said->origin[a], itk.origin[a]);
    for (std::size_t b = 0; b < 3; ++b) same = same && near(said->axis[a][b], itk.axis[a][b]);
  }
  if (!same) bad("header", "ITK understands another geometry than the header says");
}

VolumeHeader check_meta_header(std::string_view head, const fs::path& file) {
  Keys keys;
  std::size_t at = 0;
  bool ended = false;
  while (!ended && at < head.size()) {
    const std::size_t end = head.find('\n', at);
    if (end == std::string_view::npos) break;
    const std::string_view line = head.substr(at, end - at);
    at = end + 1;
    const std::size_t equals = line.find('=');
    if (trimmed(line).empty()) continue;
    if (equals == std::string_view::npos) bad("header", "a line is no key with a value");
    const std::string key = trimmed(line.substr(0, equals));
    if (!keys.emplace(key, trimmed(line.substr(equals + 1))).second) bad(key, "is given twice");
    ended = key == "ElementDataFile";
  }
  if (!ended) bad("ElementDataFile", "is missing");
  for (const char* key : {"NDims", "DimSize", "ElementSpacing", "ElementType"})
    if (keys.count(key) == 0) bad(key, "is missing");
  if (!is_true(keys, "BinaryData")) bad("BinaryData", "must be True: numbers as text are not read");
  if (keys["ElementType"] != "MET_CHAR" && keys["ElementType"] != "MET_UCHAR")
    is_true(keys, keys.count("ElementByteOrderMSB") ? "ElementByteOrderMSB" : "BinaryDataByteOrderMSB");
  if (keys["NDims"] != "3") bad("NDims", "must be 3");
  if (keys.count("ElementNumberOfChannels") && keys["ElementNumberOfChannels"] != "1")
    bad("ElementNumberOfChannels", "must be 1");
  if (keys.count("HeaderSize") && keys["HeaderSize"] != "0")
    bad("HeaderSize", "is not read: the data must follow at once");
  if (keys.count("AnatomicalOrientation") && keys.count("TransformMatrix") == 0 && keys.count("Rotation") == 0 &&
      keys.count("Orientation") == 0)
    bad("TransformMatrix", "is missing: the file does not say where it lies");
  require_plain_meaning(keys);
  ItkVolume said;
  const auto size = numbers("DimSize", keys["DimSize"], 3),
             spacing = numbers("ElementSpacing", keys["ElementSpacing"], 3),
             origin = numbers("Offset", one_of(keys, {"Offset", "Position", "Origin"}), 3),
             matrix = numbers("TransformMatrix", one_of(keys, {"TransformMatrix", "Rotation", "Orientation"}), 9);
  double voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(size[a] >= 1 && size[a] <= 65535 && size[a] == std::floor(size[a])))
      bad("DimSize", "must be whole numbers from 1 to 65535");
    voxels *= size[a];
    said.size[a] = static_cast<std::int32_t>(size[a]);
    said.spacing[a] = spacing[a];
    said.origin[a] = origin[a];
    for (std::size_t b = 0; b < 3; ++b) said.axis[a][b] = matrix[3 * a + b];
  }
  VolumeHeader out;
  out.said = said;
  out.modality = modality_of(keys);
  for (const auto& [key, value] : keys)
    if (!is_read(key) && !is_meaningless(key)) out.unknown.push_back(grid::detail::tellable_key(key));
  const std::string& data = keys["ElementDataFile"];
  const bool local = data == "LOCAL" || data == "Local" || data == "local";
  if (local)
    out.data_at = at;
  else
    out.data_file = beside(file, "ElementDataFile", data);
  const bool deflated = keys.count("CompressedData") && is_true(keys, "CompressedData");
  out.stored = deflated ? Stored::deflated : Stored::plain;
  std::error_code none;
  const double there =
      static_cast<double>(fs::file_size(local ? file : out.data_file, none)) - static_cast<double>(out.data_at);
  const double wanted = voxels * bytes_of_meta_type(keys["ElementType"]);
  if (deflated) {
    if (there * 1032 < wanted) bad("data", "the file is cut short");
    if (wanted > static_cast<double>(grid::scan_limit.bytes(static_cast<std::uint64_t>(there))))
      bad("data", to_text(there) + " bytes would grow to " + to_text(wanted) + ", which no scan's do");
    if (keys.count("CompressedDataSize") && numbers("CompressedDataSize", keys["CompressedDataSize"], 1)[0] > there)
      bad("data", "the file is cut short");
  } else if (there != wanted) {
    bad("data", "holds " + to_text(there) + " bytes, the header says " + to_text(wanted));
  }
  return out;
}

VolumeHeader check_nrrd_text(std::string_view head, const fs::path& file) {
  VolumeHeader out;
  bool directions = false, origin = false;
  std::set<std::string> seen;
  std::size_t at = 0;
  while (at < head.size()) {
    const std::size_t end = std::min(head.find('\n', at), head.size());
    const std::string line = trimmed(head.substr(at, end - at));
    at = end + 1;
    if (line.empty()) break;
    const std::size_t colon = line.find(": ");
    if (line[0] == '#' || colon == std::string::npos) continue;
    const std::string value = trimmed(line.substr(colon + 2));
    // The reader knows keys in any case, with and without spaces.
    const std::string written = line.substr(0, colon);
    std::string key;
    for (const char c : written)
      if (c != ' ') key += char(std::tolower(static_cast<unsigned char>(c)));
    if (!seen.insert(key).second) bad(written, "is given twice");
    directions = directions || key == "spacedirections";
    origin = origin || key == "spaceorigin";
    if (key == "encoding" && value == "raw") out.stored = Stored::plain;
    if (key == "encoding" && (value == "gzip" || value == "gz")) out.stored = Stored::deflated;
    if (key == "datafile") out.data_file = beside(file, "data file", value);
    if (key == "lineskip" || key == "byteskip")
      if (value != "0") bad(written, "is not read: the data must follow at once");
    if (!grid::detail::is_known_field(key)) out.unknown.push_back(grid::detail::tellable_key(written));
    for (const char* scale : {"oldmin", "oldmax", "axismins", "axismaxs"})
      if (key == scale && value.find_first_not_of("nNaAoOeE \t") != std::string::npos)
        bad(written, "changes what the values or their places mean: convert the file");
    if (key == "kinds")
      for (const std::string& word : split_at(value, ' '))
        if (!word.empty() && word != "domain" && word != "space" && word != "none" && word != "???")
          bad(written, "must be domain: each voxel holds one number");
    if (key == "spaceunits" || key == "units")
      for (const std::string& word : split_at(value, ' '))
        if (!word.empty() && word != "\"mm\"" && word != "\"\"") bad(written, "must be mm");
    if (key == "space" && value != "left-posterior-superior" && value != "LPS" && value != "right-anterior-superior" &&
        value != "RAS" && value != "left-anterior-superior" && value != "LAS")
      bad(written, "is none that is read: left-posterior-superior or right-anterior-superior");
  }
  if (out.data_file.empty()) out.data_at = std::min(at, head.size());
  if (!directions) bad("space directions", "is missing: the file does not say where it lies");
  if (!origin) bad("space origin", "is missing: the file does not say where it lies");
  if (out.data_file.empty() && file.extension() == ".nhdr") bad("data file", "is missing: the header says no data");
  return out;
}

}  // namespace trephine::itk
