// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/volume_header.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "itk/header_numbers.h"

namespace trephine {
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

}  // namespace

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
  const std::string& data = keys["ElementDataFile"];
  const bool local = data == "LOCAL" || data == "Local" || data == "local";
  if (!local) out.data_file = beside(file, "ElementDataFile", data);
  std::error_code none;
  const double there =
      static_cast<double>(fs::file_size(local ? file : out.data_file, none)) - (local ? static_cast<double>(at) : 0);
  const double wanted = voxels * bytes_of_meta_type(keys["ElementType"]);
  if (keys.count("CompressedData") && is_true(keys, "CompressedData")) {
    if (there * 1032 < wanted) bad("data", "the file is cut short");
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
    if (key == "datafile") out.data_file = beside(file, "data file", value);
    if (key == "lineskip" || key == "byteskip")
      if (value != "0") bad(written, "is not read: the data must follow at once");
    if (key == "spaceunits" || key == "units")
      for (const std::string& word : split_at(value, ' '))
        if (!word.empty() && word != "\"mm\"" && word != "\"\"") bad(written, "must be mm");
    if (key == "space" && value != "left-posterior-superior" && value != "LPS" && value != "right-anterior-superior" &&
        value != "RAS" && value != "left-anterior-superior" && value != "LAS")
      bad(written, "is none that is read: left-posterior-superior or right-anterior-superior");
  }
  if (!directions) bad("space directions", "is missing: the file does not say where it lies");
  if (!origin) bad("space origin", "is missing: the file does not say where it lies");
  if (out.data_file.empty() && file.extension() == ".nhdr") bad("data file", "is missing: the header says no data");
  return out;
}

}  // namespace trephine
