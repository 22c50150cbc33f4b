// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/srgb.h"
#include "base/write_file.h"
#include "cases/glb.h"
#include "cases/glb_layout.h"
#include "json/json_at.h"

namespace trephine::cases {
namespace {

using At = json::JsonAt;
constexpr std::size_t max_json_bytes = 1 << 16;
using detail::gltf_float, detail::gltf_triangles, detail::gltf_uint16, detail::gltf_uint32;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", "glb." + field, what);
}

std::uint32_t le32(std::string_view bytes, std::size_t at) {
  std::uint32_t v;
  std::memcpy(&v, bytes.data() + at, 4);
  return v;
}

struct Chunks {
  std::string_view json, binary;
};

// Header, JSON chunk, binary chunk, end: nothing before, between or after.
Chunks chunks_of(std::string_view bytes) {
  constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
  if (bytes.size() < 28 || bytes.substr(0, 4) != "glTF") refuse("header", "not a binary glTF file");
  if (le32(bytes, 4) != 2) refuse("header", "version " + std::to_string(le32(bytes, 4)) + ", must be 2");
  if (le32(bytes, 8) != bytes.size()) refuse("header", "the length is not that of the file");
  const std::uint32_t json_size = le32(bytes, 12);
  if (le32(bytes, 16) != json_chunk || json_size % 4 != 0 || json_size > max_json_bytes ||
      json_size > bytes.size() - 28)
    refuse("header", "the JSON chunk is damaged");
  const std::size_t at = 20 + std::size_t{json_size};
  const std::uint32_t binary_size = le32(bytes, at);
  if (le32(bytes, at + 4) != binary_chunk || binary_size % 4 != 0 || at + 8 + binary_size != bytes.size())
    refuse("header", "the binary chunk is damaged");
  return {bytes.substr(20, json_size), bytes.substr(at + 8)};
}

struct View {
  const char* data;
  std::uint64_t count;
};

// The accessor's samples, all within the binary chunk.
View view_of(const At& root, std::uint64_t index, const char* type, std::uint64_t component, std::uint64_t size,
             std::string_view binary) {
  const At accessor = root["accessors"].item(index);
  if (accessor["type"].text() != type) accessor["type"].refuse(std::string("must be ") + type);
  if (accessor["componentType"].count(65535) != component)
    accessor["componentType"].refuse("must be " + std::to_string(component));
  for (const char* key : {"sparse", "byteOffset", "normalized"})
    if (accessor.has(key)) accessor[key].refuse("is not supported");
  const At view = root["bufferViews"].item(accessor["bufferView"].count(1 << 16));
  if (view["buffer"].count(0) != 0 || view.has("byteStride")) view.refuse("must be packed, in buffer 0");
  const std::uint64_t offset = view.has("byteOffset") ? view["byteOffset"].count(binary.size()) : 0;
  const std::uint64_t length = view["byteLength"].count(binary.size() - offset);
  const std::uint64_t count = accessor["count"].count(length / size);
  if (offset % 4 != 0 || count * size != length) view.refuse("does not hold what the accessor says");
  return {binary.data() + offset, count};
}

std::vector<Vec3> vectors_of(const View& view, const char* field) {
  std::vector<Vec3> out(view.count);
  for (std::uint64_t i = 0; i < view.count; ++i) {
    float f[3];
    std::memcpy(f, view.data + i * sizeof f, sizeof f);
    out[i] = {f[0], f[1], f[2]};
    if (!is_finite(out[i])) refuse(field, "vertex " + std::to_string(i) + " is not finite");
  }
  return out;
}

template <class T>
std::vector<std::array<std::uint32_t, 3>> triangles_of(const View& view, std::uint64_t points) {
  if (view.count % 3 != 0 || view.count == 0) refuse("indices", "must be three a triangle");
  std::vector<std::array<std::uint32_t, 3>> out(view.count / 3);
  for (std::uint64_t i = 0; i < view.count; ++i) {
    T v;
    std::memcpy(&v, view.data + i * sizeof v, sizeof v);
    if (v >= points) refuse("indices", std::to_string(v) + ", there are " + std::to_string(points) + " vertices");
    out[i / 3][i % 3] = v;
  }
  return out;
}

void check_bounds(const At& accessor, const std::vector<Vec3>& points) {
  Vec3 least = points[0], most = points[0];
  for (const Vec3 p : points)
    for (int c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], p[c]);
      most[c] = std::max(most[c], p[c]);
    }
  const auto min = accessor["min"].numbers(3), max = accessor["max"].numbers(3);
  for (int c = 0; c < 3; ++c)
    if (min[c] != least[c] || max[c] != most[c]) accessor.refuse("min or max is not that of the vertices");
}

GlbMesh mesh_of(const json::Json& json, std::string_view binary) {
  const At root(json, "glb");
  if (root["asset"]["version"].text() != "2.0") refuse("asset.version", "must be 2.0");
  if (root.has("extensionsRequired")) refuse("extensionsRequired", "is not supported");
  const At buffer = root["buffers"].only();
  if (buffer.has("uri")) refuse("buffers", "must lie in the file");
  const std::uint64_t length = buffer["byteLength"].count(binary.size());
  if (binary.size() - length > 3) refuse("buffers", "shorter than the binary chunk");
  binary = binary.substr(0, length);

  const At node = root["nodes"].only();
  const auto matrix = node["matrix"].numbers(16);
  if (!std::equal(matrix.begin(), matrix.end(), detail::gltf_from_lps.begin()))
    refuse("nodes.matrix", "is not that from LPS millimetres to metres, Y up");
  const At extras = node["extras"];
  if (extras["frame"].text() != "LPS" || extras["unit"].text() != "mm") refuse("nodes.extras", "must be LPS and mm");
  const auto center = extras["center_mm"].numbers(3);

  const At primitive = root["meshes"].only()["primitives"].only();
  if (primitive.has("targets")) refuse("primitives.targets", "is not supported");
  if (primitive.has("mode") && primitive["mode"].count(10) != gltf_triangles)
    refuse("primitives.mode", "must be triangles");
  const At attributes = primitive["attributes"];
  const std::uint64_t max_items = 1 << 16;
  const std::uint64_t position_index = attributes["POSITION"].count(max_items);
  const View positions = view_of(root, position_index, "VEC3", gltf_float, 12, binary);
  const View normals = view_of(root, attributes["NORMAL"].count(max_items), "VEC3", gltf_float, 12, binary);
  if (positions.count == 0 || normals.count != positions.count) refuse("attributes", "one normal a vertex is wanted");

  GlbMesh out;
  out.mesh.origin_mm = {center[0], center[1], center[2]};
  out.mesh.points_mm = vectors_of(positions, "POSITION");
  out.mesh.normals = vectors_of(normals, "NORMAL");
  for (std::size_t i = 0; i < out.mesh.normals.size(); ++i)
    if (!(std::abs(norm(out.mesh.normals[i]) - 1) < 1e-3))
      refuse("NORMAL", "of vertex " + std::to_string(i) + " is not of length 1");
  check_bounds(root["accessors"].item(position_index), out.mesh.points_mm);
  const std::uint64_t i = primitive["indices"].count(max_items);
  if (root["accessors"].item(i)["componentType"].count(65535) == gltf_uint16)
    out.mesh.triangles =
        triangles_of<std::uint16_t>(view_of(root, i, "SCALAR", gltf_uint16, 2, binary), positions.count);
  else
    out.mesh.triangles =
        triangles_of<std::uint32_t>(view_of(root, i, "SCALAR", gltf_uint32, 4, binary), positions.count);

  const At material = root["materials"].item(primitive["material"].count(max_items));
  const auto colour = material["pbrMetallicRoughness"]["baseColorFactor"].numbers(4);
  for (int c = 0; c < 4; ++c)
    if (!(colour[c] >= 0 && colour[c] <= 1)) refuse("baseColorFactor", "must lie between 0 and 1");
  for (int c = 0; c < 3; ++c) out.colour_rgb[c] = srgb_of_linear(colour[c]);
  out.opacity = colour[3];
  out.name = node["name"].text();
  return out;
}

}  // namespace

GlbMesh read_glb(std::string_view bytes) {
  const Chunks chunks = chunks_of(bytes);
  return mesh_of(with_field("glb", [&] { return json::parse_json(chunks.json); }), chunks.binary);
}

GlbMesh read_glb_file(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  try {
    return read_glb(std::string_view(bytes.data(), bytes.size()));
  } catch (Error& e) {
    e.in_file(file.string());
    throw;
  }
}

}  // namespace trephine::cases
