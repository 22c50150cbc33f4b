// SPDX-License-Identifier: GPL-3.0-or-later
// ITK 5.2 takes any line that holds "spacing", "origin", "scalars" or "vector" for that key, 1 mm and 0 for what is
// missing, and passes over all that it does not look for, also a second array behind the first.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "grid/nrrd_header.h"
#include "itk/header_numbers.h"
#include "plain_header.h"

namespace trephine::itk {
namespace {

using detail::bad;
using Words = std::vector<std::string>;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

Words words_of(const std::string& line) {
  Words words;
  for (const std::string& word : split_at(line, ' '))
    if (!trimmed(word).empty()) words.push_back(trimmed(word));
  return words;
}

/// The next line that is not empty, without blanks at its ends. A line of the header is short; what is longer is not
/// the line that is wanted.
std::string next_line(std::ifstream& in, const char* wanted = "header") {
  constexpr std::size_t max_line = 4096;
  std::string line;
  while (trimmed(line).empty()) {
    line.clear();
    for (char c = 0; in.get(c) && c != '\n';) {
      line += c == '\t' ? ' ' : c;
      if (line.size() > max_line) bad(wanted, "is missing, or a line of the header has more than 4,096 letters");
    }
    if (!in) bad(wanted, "is missing: the header ends before its array of scalars");
  }
  return trimmed(line);
}

const std::set<std::string>& keys_that_are_read() {
  static const std::set<std::string> keys = {"dimensions", "spacing", "aspect_ratio", "origin",
                                             "point_data", "scalars", "lookup_table"};
  return keys;
}
/// What VTK knows and a volume of one value a voxel has no use for; each would mean other voxels or another place.
const std::set<std::string>& keys_that_are_refused() {
  static const std::set<std::string> keys = {
      "dataset",       "cell_data",     "field",        "vectors",       "normals", "texture_coordinates",
      "tensors",       "tensors6",      "binary",       "color_scalars", "ascii",   "metadata",
      "x_coordinates", "y_coordinates", "points",       "direction",     "cells",   "global_ids",
      "extent",        "z_coordinates", "pedigree_ids", "edge_flags"};
  return keys;
}

bool itk_would_take(const std::string& line) {
  for (const char* word : {"spacing", "aspect_ratio", "origin", "vector", "scalars", "tensors"})
    if (line.find(word) != std::string::npos) return true;
  return false;
}

std::size_t bytes_of_type(const std::string& type) {
  static const std::map<std::string, std::size_t> types = {
      {"char", 1}, {"unsigned_char", 1}, {"short", 2}, {"unsigned_short", 2},
      {"int", 4},  {"unsigned_int", 4},  {"float", 4}, {"double", 8}};
  const auto found = types.find(type);
  if (found == types.end()) bad("SCALARS", "of this type are not read: 8, 16 and 32 bits, float and double are");
  return found->second;
}

std::vector<double> three(const std::string& key, const Words& words) {
  std::string rest;
  for (std::size_t n = 1; n < words.size(); ++n) rest += words[n] + " ";
  const std::vector<double> found = detail::numbers_of(key, rest);
  if (found.size() != 3) bad(key, "must be three numbers");
  return found;
}

/// What may follow the voxels: nothing, or the block METADATA that VTK itself writes behind an array, up to an empty
/// line.
void require_no_more(std::ifstream& in) {
  std::string line;
  bool in_block = false;
  while (std::getline(in, line)) {
    if (line.size() > 4096) bad("data", "more follows than the header says");
    const std::string text = lower(trimmed(line));
    if (in_block)
      in_block = !text.empty();
    else if (text == "metadata")
      in_block = true;
    else if (!text.empty())
      bad("data", "more follows than the header says: one array of scalars is read, and nothing else");
  }
}

void require_binary(std::ifstream& in, const std::string& file, std::uint64_t bytes) {
  const auto at = static_cast<std::uint64_t>(in.tellg());
  std::error_code none;
  const std::uint64_t whole = std::filesystem::file_size(file, none);
  if (none || whole < at || whole - at < bytes) bad("data", "holds fewer bytes than the header says");
  in.seekg(static_cast<std::streamoff>(at + bytes));
  require_no_more(in);
}

void require_text(std::ifstream& in, std::uint64_t count) {
  std::string word;
  for (std::uint64_t n = 0; n < count; ++n) {
    if (!(in >> word)) bad("data", "holds fewer values than the header says");
    if (!parse_number(word)) bad("data", "holds what is no finite number");
  }
  require_no_more(in);
}

}  // namespace

VolumeHeader check_vtk_file(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (next_line(in).rfind("# vtk DataFile Version ", 0) != 0) bad("header", "does not begin as VTK's files do");
  next_line(in);  // the title: ITK passes over empty lines too, so that an empty title is refused by what follows
  const std::string kind = lower(next_line(in));
  if (kind != "binary" && kind != "ascii") bad("header", "must say BINARY or ASCII in its third line");
  const Words set = words_of(lower(next_line(in)));
  if (set != Words{"dataset", "structured_points"}) bad("DATASET", "must be STRUCTURED_POINTS");

  std::map<std::string, Words> keys;
  VolumeHeader out;
  while (keys.count("lookup_table") == 0) {
    const std::string line = next_line(in, keys.count("scalars") ? "LOOKUP_TABLE" : "header");
    const Words words = words_of(line);
    std::string key = lower(words[0]);
    const std::string told = grid::detail::tellable_key(words[0]);
    if (keys.empty() && key != "dimensions") bad("DIMENSIONS", "must follow the kind of data set");
    if (keys.count("scalars") && key != "lookup_table") bad("LOOKUP_TABLE", "is missing: it must follow the scalars");
    if (keys_that_are_refused().count(key)) bad(told, "is not read: one array of scalars on points is");
    if (keys_that_are_read().count(key) == 0) {
      if (itk_would_take(lower(line))) bad(told, "is no key of VTK, and ITK would take it for one");
      out.unknown.push_back(told);
      continue;
    }
    if (key == "aspect_ratio") key = "spacing";
    if (!keys.emplace(key, words).second) bad(told, "is given twice");
  }
  for (const char* key : {"spacing", "origin", "point_data", "scalars"})
    if (keys.count(key) == 0) bad(key, "is missing: the file does not say what its voxels are, or where they lie");

  ItkVolume said;
  const std::vector<double> size = three("DIMENSIONS", keys["dimensions"]), step = three("SPACING", keys["spacing"]),
                            origin = three("ORIGIN", keys["origin"]);
  std::uint64_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(size[a] >= 1 && size[a] <= 65535 && size[a] == double(std::int32_t(size[a]))))
      bad("DIMENSIONS", "must be whole numbers from 1 to 65535");
    said.size[a] = static_cast<std::int32_t>(size[a]);
    count *= static_cast<std::uint64_t>(size[a]);
    said.spacing[a] = step[a];
    said.origin[a] = origin[a];
    said.axis[a][a] = 1;
  }
  const Words &points = keys["point_data"], &scalars = keys["scalars"];
  if (points.size() != 2 || parse_number(points[1]) != double(count))
    bad("POINT_DATA", "is not the number of voxels that DIMENSIONS says");
  if (scalars.size() < 3 || scalars.size() > 4 || (scalars.size() == 4 && scalars[3] != "1"))
    bad("SCALARS", "must say a name, a type, and at most that each voxel has 1 value");
  const std::size_t bytes = bytes_of_type(lower(scalars[2]));
  out.said = said;
  if (kind == "binary")
    require_binary(in, file, count * bytes);
  else
    require_text(in, count);
  return out;
}

}  // namespace trephine::itk
