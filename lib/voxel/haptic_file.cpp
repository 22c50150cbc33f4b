// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/haptic_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"
#include "grid/nrrd.h"

namespace trephine::voxel {
namespace {

constexpr int format_version = 1;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

const char* to_text(HapticEncoding e) { return e == HapticEncoding::occupancy ? "occupancy" : "hu"; }

std::string shapes_json(const HapticVolume& volume) {
  nlohmann::ordered_json j;
  j["version"] = format_version;
  j["encoding"] = to_text(volume.encoding);
  j["shapes"] = nlohmann::ordered_json::array();
  for (const HapticShape& s : volume.shapes)
    j["shapes"].push_back({{"name", s.name}, {"number", s.number}, {"window", {s.window_low, s.window_high}}});
  return j.dump();
}

using Json = nlohmann::json;

const Json& member(const Json& object, const char* name, const std::string& field) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  if (!object.is_object() || found == object.end()) refuse(field + name, "missing");
  return *found;
}

int integer(const Json& value, int low, int high, const std::string& field) {
  if (!value.is_number_integer()) refuse(field, "must be a whole number");
  const bool large = value.is_number_unsigned() && value.get<std::uint64_t>() > std::uint64_t(high);
  if (large || value.get<std::int64_t>() < low || value.get<std::int64_t>() > high)
    refuse(field, "must be from " + std::to_string(low) + " to " + std::to_string(high));
  return value.get<int>();
}

std::string text(const Json& value, const std::string& field) {
  if (!value.is_string()) refuse(field, "must be text");
  return value.get<std::string>();
}

void read_shapes(const std::string& json_text, HapticVolume& volume) {
  const std::string field = std::string(haptic_file_key) + ".";
  // 32 shapes take less than 5 KiB; a stranger's text must not cost many times its size.
  if (json_text.size() > 16384) refuse(haptic_file_key, "is longer than 32 shapes can be");
  const Json j = Json::parse(json_text, nullptr, false);
  if (j.is_discarded()) refuse(haptic_file_key, "is not JSON");
  const Json& version = member(j, "version", field);
  if (!version.is_number_integer() || version != format_version)
    refuse(field + "version", "this program reads version " + std::to_string(format_version));
  const std::string encoding = text(member(j, "encoding", field), field + "encoding");
  if (encoding != "occupancy" && encoding != "hu") refuse(field + "encoding", "must be occupancy or hu");
  volume.encoding = encoding == "hu" ? HapticEncoding::hu : HapticEncoding::occupancy;
  const Json& shapes = member(j, "shapes", field);
  if (!shapes.is_array() || shapes.size() > std::size_t(haptic_max_shapes))
    refuse(field + "shapes", "must be a list of at most " + std::to_string(haptic_max_shapes));
  for (const Json& s : shapes) {
    const std::string at = field + "shapes[" + std::to_string(volume.shapes.size()) + "].";
    HapticShape shape;
    shape.name = text(member(s, "name", at), at + "name");
    shape.number = integer(member(s, "number", at), 1, haptic_max_shapes, at + "number");
    const Json& window = member(s, "window", at);
    if (!window.is_array() || window.size() != 2) refuse(at + "window", "must be two numbers");
    shape.window_low = std::int16_t(integer(window[0], -32768, 32767, at + "window"));
    shape.window_high = std::int16_t(integer(window[1], -32768, 32767, at + "window"));
    volume.shapes.push_back(std::move(shape));
  }
}

}  // namespace

std::string encode_haptic(const HapticVolume& volume) {
  return grid::encode_nrrd(volume.voxels, {{haptic_file_key, shapes_json(volume)}});
}

std::string encode_hardness(const HapticVolume& volume) { return grid::encode_nrrd(volume.hardness); }

namespace {

HapticVolume unchecked(grid::AnyGrid grid, const grid::NrrdKeys& keys) {
  auto* voxels = std::get_if<grid::Grid<std::int16_t>>(&grid);
  if (!voxels) refuse("type", "a haptic volume is int16");
  const auto key = keys.find(haptic_file_key);
  if (key == keys.end()) refuse(haptic_file_key, "missing: not a haptic volume");
  HapticVolume volume;
  read_shapes(key->second, volume);
  volume.voxels = std::move(*voxels);
  return volume;
}

}  // namespace

HapticVolume haptic_of(grid::AnyGrid voxels, const grid::NrrdKeys& keys) {
  HapticVolume volume = unchecked(std::move(voxels), keys);
  check_haptic_volume(volume);
  return volume;
}

HapticVolume decode_haptic(std::string_view bytes, std::string_view hardness) {
  grid::Nrrd nrrd = grid::decode_nrrd(bytes);
  HapticVolume volume = unchecked(std::move(nrrd.grid), nrrd.keys);
  if (!hardness.empty()) try {
      grid::Nrrd h = grid::decode_nrrd(hardness);
      auto* mask = std::get_if<grid::Mask>(&h.grid);
      if (!mask) refuse("type", "hardness is uint8");
      volume.hardness = std::move(*mask);
    } catch (Error& e) {
      e.in_field("hardness").finds_fault_with({hardness_part});
      throw;
    }
  check_haptic_volume(volume);
  return volume;
}

void write_haptic(const std::filesystem::path& file, const HapticVolume& volume) {
  write_file(file, encode_haptic(volume));
}

HapticVolume read_haptic(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file);
    return decode_haptic({bytes.data(), bytes.size()});
  });
}

}  // namespace trephine::voxel
