// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "grid/bounded_read.h"
#include "grid/nifti.h"

namespace trephine::grid {
namespace {

constexpr int max_segments = 4096;
constexpr std::size_t max_named = 20;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

std::string lower(std::string s) {
  for (char& c : s)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return s;
}

/// "0 381 0 196 0 124", the first and last voxel along each axis; an empty segment has its last before its first.
bool reaches_beyond(const std::string& extent, const Lattice& l) {
  std::vector<long long> numbers;
  std::string word;
  for (const char c : extent + " ") {
    if (c != ' ') {
      word.push_back(c);
    } else if (!word.empty()) {
      const auto n = parse_integer(word);
      if (!n) return false;
      numbers.push_back(*n);
      word.clear();
    }
  }
  if (numbers.size() != 6) return false;
  bool beyond = false;
  for (std::size_t a = 0; a < 3; ++a) {
    if (numbers[2 * a] > numbers[2 * a + 1]) return false;
    beyond = beyond || numbers[2 * a] < 0 || numbers[2 * a + 1] >= l.size[a];
  }
  return beyond;
}

std::vector<LabelSegment> segments_of(const NrrdKeys& keys, const LayeredNrrd& file) {
  std::vector<LabelSegment> all;
  const auto number = [&](const std::string& key, int otherwise, int most) {
    const auto found = keys.find(key);
    if (found == keys.end()) return otherwise;
    const auto n = parse_integer(found->second);
    if (!n || *n < 0 || *n > most) refuse(key, "'" + found->second + "' is out of range");
    return int(*n);
  };
  for (int s = 0; s < max_segments; ++s) {
    const std::string prefix = "Segment" + std::to_string(s) + "_";
    const auto id = keys.find(prefix + "ID"), name = keys.find(prefix + "Name");
    if (id == keys.end() && name == keys.end()) break;
    LabelSegment segment;
    if (id != keys.end()) segment.id = id->second;
    segment.name = name != keys.end() ? name->second : segment.id;
    // Files from before layers could be shared have neither key: each segment has a layer of its own, with the value 1.
    segment.layer = number(prefix + "Layer", file.layers > 1 ? s : 0, file.layers - 1);
    segment.value = number(prefix + "LabelValue", 1, 1 << 24);
    if (const auto extent = keys.find(prefix + "Extent"); extent != keys.end())
      segment.cropped = reaches_beyond(extent->second, file.lattice);
    all.push_back(segment);
  }
  return all;
}

/// Which samples belong to a segment: those of all layers or of one, with one value or with any but 0.
struct Wanted {
  std::optional<int> layer;
  std::optional<double> value;
};

template <class T>
std::size_t take(const Grid<T>& samples, const LabelFile& map, const Wanted& wanted, Mask& mask) {
  std::size_t count = 0;
  const std::size_t layers = std::size_t(map.layers);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) {
    bool is = false;
    for (std::size_t l = wanted.layer ? std::size_t(*wanted.layer) : 0;
         l < (wanted.layer ? std::size_t(*wanted.layer) + 1 : layers); ++l) {
      const double s = double(samples.voxels[v * layers + l]);
      is = is || (wanted.value ? s == *wanted.value : s != 0);
    }
    mask.voxels[v] = is;
    count += is;
  }
  return count;
}

/// The values other than 0; at most `max_named` + 1 of them, which shows that there are more than can be named.
std::set<long long> values_of(const LabelFile& map) {
  std::set<long long> values;
  std::visit(
      [&](const auto& g) {
        long long last = 0;
        for (const auto s : g.voxels) {
          const auto n = static_cast<long long>(s);
          if (n == last || n == 0) continue;
          last = n;
          values.insert(n);
          if (values.size() > max_named) break;
        }
      },
      map.samples);
  return values;
}

std::string names_of(const LabelFile& map) {
  std::string text;
  std::size_t n = 0;
  const auto add = [&](const std::string& item) {
    if (n++ < max_named) text += (text.empty() ? "" : ", ") + item;
  };
  for (const LabelSegment& s : map.segments) add(s.name + " (" + std::to_string(s.value) + ")");
  if (map.segments.empty())
    for (const long long v : values_of(map)) add(std::to_string(v));
  if (n > max_named) text += ", ...";
  return text.empty() ? "no label" : text;
}

void check_whole(const LabelFile& map) {
  std::visit(
      [](const auto& g) {
        for (std::size_t v = 0; v < g.voxels.size(); ++v)
          if (g.voxels[v] < 0)
            refuse("data", "voxel " + std::to_string(v) + " holds " + to_text(double(g.voxels[v])) +
                               ": no map of labels, which are not negative; is it a CT volume or a field?");
      },
      map.samples);
  const auto* g = std::get_if<Grid<float>>(&map.samples);
  if (!g) return;
  for (std::size_t v = 0; v < g->voxels.size(); ++v)
    if (g->voxels[v] != std::floor(g->voxels[v]))
      refuse("data", "voxel " + std::to_string(v) + " holds " + to_text(double(g->voxels[v])) +
                         ": no map of labels, which are whole numbers");
}

std::vector<const LabelSegment*> segments_called(const LabelFile& map, const std::string& label) {
  for (const bool exact : {true, false}) {
    std::vector<const LabelSegment*> found;
    for (const LabelSegment& s : map.segments)
      if (exact ? s.name == label || s.id == label : lower(s.name) == lower(label) || lower(s.id) == lower(label))
        found.push_back(&s);
    if (!found.empty()) return found;
  }
  return {};
}

Wanted wanted_of(const LabelFile& map, const std::string& label, PickedLabel& out) {
  Wanted wanted;
  if (label.empty()) {
    out.name = "all";
    return wanted;
  }
  auto found = segments_called(map, label);
  const auto value = parse_integer(label);
  if (found.empty() && value)
    for (const LabelSegment& s : map.segments)
      if (s.value == *value) found.push_back(&s);
  if (found.size() > 1)
    refuse("label", "'" + label + "' is in several segments: " + names_of(map) + "; give the one's ID");
  if (found.size() == 1) {
    out.name = found[0]->name;
    wanted.layer = found[0]->layer;
    wanted.value = found[0]->value;
    return wanted;
  }
  if (!value || map.layers > 1 || *value == 0) refuse("label", "no '" + label + "' in the file, but " + names_of(map));
  out.name = label;
  wanted.value = double(*value);
  return wanted;
}

}  // namespace

LabelFile decode_labels(std::string_view bytes) {
  LabelFile map;
  if (bytes.substr(0, 4) == "NRRD") {
    LayeredNrrd file = decode_layered_nrrd(bytes);
    map.segments = segments_of(file.keys, file);
    map.format = map.segments.empty() ? "NRRD" : "seg.nrrd";
    for (const char* key : {"Segmentation_SourceRepresentation", "Segmentation_MasterRepresentation"}) {
      const auto found = file.keys.find(key);
      if (found != file.keys.end() && found->second.find("Fractional") != std::string::npos)
        refuse(key, "'" + found->second + "': export it as a binary labelmap");
    }
    map.lattice = file.lattice;
    map.layers = file.layers;
    map.samples = std::move(file.samples);
  } else if (may_be_nifti(bytes)) {
    Nifti file = decode_nifti(bytes);
    map.format = "NIfTI";
    map.lattice = std::visit([](const auto& g) -> Lattice { return g; }, file.grid);
    map.samples = std::move(file.grid);
    map.warnings = std::move(file.warnings);
  } else {
    refuse("header", "neither NRRD nor NIfTI");
  }
  check_whole(map);
  return map;
}

LabelFile labels_of(AnyGrid samples, const std::string& format) {
  LabelFile map;
  map.format = format;
  map.lattice = std::visit([](const auto& g) -> Lattice { return g; }, samples);
  map.samples = std::move(samples);
  check_whole(map);
  return map;
}

LabelFile read_labels(const std::filesystem::path& file) {
  return with_file(file.string(), [&] { return read_labels_bounded(file); });
}

std::string encode_labels(const LabelFile& map) {
  const auto* bytes = std::get_if<Mask>(&map.samples);
  const auto* shorts = std::get_if<Grid<std::int16_t>>(&map.samples);
  if (map.layers != 1 || (!bytes && !shorts))
    throw Error(ExitCode::internal, "", "labels", "must be one layer of uint8 or int16");
  NrrdKeys keys;
  for (std::size_t i = 0; i < map.segments.size(); ++i) {
    const std::string segment = "Segment" + std::to_string(i) + "_";
    keys[segment + "ID"] = map.segments[i].id;
    keys[segment + "Name"] = map.segments[i].name;
    keys[segment + "LabelValue"] = std::to_string(map.segments[i].value);
    keys[segment + "Layer"] = "0";
  }
  return bytes ? encode_nrrd(*bytes, keys, NrrdEncoding::gzip)
               : encode_nrrd(HuVolume(*shorts), keys, NrrdEncoding::gzip);
}

namespace {

PickedLabel pick_one(const LabelFile& map, const std::string& label) {
  PickedLabel out;
  const Wanted wanted = wanted_of(map, label, out);
  out.mask = Mask(map.lattice);
  out.voxels = std::visit([&](const auto& g) { return take(g, map, wanted, out.mask); }, map.samples);
  return out;
}

/// The labels of a list together. A part that this scan does not show may be missing, but not all.
PickedLabel pick_several(const LabelFile& map, const std::string& labels) {
  PickedLabel out;
  out.mask = Mask(map.lattice);
  for (const std::string& part : split_at(labels, ',')) {
    const std::size_t from = part.find_first_not_of(' ');
    if (from == std::string::npos) refuse("label", "'" + labels + "' names nothing between two commas");
    const PickedLabel one = pick_one(map, part.substr(from, part.find_last_not_of(' ') - from + 1));
    out.name += (out.name.empty() ? "" : ", ") + one.name;
    for (std::size_t v = 0; v < out.mask.voxels.size(); ++v) {
      out.voxels += one.mask.voxels[v] && !out.mask.voxels[v];
      out.mask.voxels[v] |= one.mask.voxels[v];
    }
  }
  return out;
}

}  // namespace

PickedLabel pick_label(const LabelFile& map, const std::string& label) {
  const bool several = label.find(',') != std::string::npos && segments_called(map, label).empty();
  PickedLabel out = several ? pick_several(map, label) : pick_one(map, label);
  if (!out.voxels && !label.empty() && map.segments.empty())
    refuse("label", "no voxel is " + label + ", but " + names_of(map));
  return out;
}

}  // namespace trephine::grid
