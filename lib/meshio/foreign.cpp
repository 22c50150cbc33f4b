// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/foreign.h"

#include <cstring>

#include "base/error.h"

namespace trephine {
namespace {

constexpr const char* worker_name = "mesh-read";

template <class T>
void put(std::string& out, const T& v) {
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

void put_text(std::string& out, std::string_view s) {
  put(out, std::uint64_t(s.size()));
  out.append(s);
}

template <class Item>
void put_items(std::string& out, const std::vector<Item>& items) {
  put(out, std::uint64_t(items.size()));
  out.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
}

// What one side packed; the other trusts no length of it.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}
  bool done() const { return rest_.empty(); }
  template <class T>
  T take() {
    T v;
    std::memcpy(&v, piece(sizeof v).data(), sizeof v);
    return v;
  }
  std::string_view text() { return piece(take<std::uint64_t>()); }
  template <class Item>
  std::vector<Item> items() {
    const auto count = take<std::uint64_t>();
    if (count > rest_.size() / sizeof(Item)) too_short();
    std::vector<Item> v(count);
    const std::string_view from = piece(count * sizeof(Item));
    if (count) std::memcpy(v.data(), from.data(), from.size());
    return v;
  }

 private:
  [[noreturn]] static void too_short() {
    throw Error(ExitCode::internal, "", worker_name, "what parent and child handed over is too short");
  }
  std::string_view piece(std::uint64_t size) {
    if (size > rest_.size()) too_short();
    const std::string_view p = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return p;
  }
  std::string_view rest_;
};

std::string packed(const ForeignSurface& s) {
  std::string out;
  put_text(out, s.name);
  put(out, std::uint8_t(s.has_colour));
  put(out, std::uint8_t(s.has_opacity));
  put(out, s.colour);
  put(out, s.opacity);
  put(out, s.texture_points);
  put_items(out, s.points);
  put_items(out, s.triangles);
  return out;
}

ForeignSurface unpacked(Unpacker& in) {
  ForeignSurface s;
  s.name = in.text();
  s.has_colour = in.take<std::uint8_t>() != 0;
  s.has_opacity = in.take<std::uint8_t>() != 0;
  s.colour = in.take<std::array<double, 3>>();
  s.opacity = in.take<double>();
  s.texture_points = in.take<std::uint64_t>();
  s.points = in.items<Vec3>();
  s.triangles = in.items<std::array<std::uint32_t, 3>>();
  return s;
}

void check(const ForeignSurface& s) {
  for (const Vec3 p : s.points)
    if (!is_finite(p)) throw Error(ExitCode::bad_input, "", "", "damaged: a point is not finite");
  for (const auto& t : s.triangles)
    for (const std::uint32_t i : t)
      if (i >= s.points.size())
        throw Error(ExitCode::bad_input, "", "",
                    "damaged: point index " + std::to_string(i) + " of " + std::to_string(s.points.size()) + " points");
}

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  Unpacker in(request.request());
  const auto reader = in.take<ForeignReader>();
  const std::string_view bytes = in.text(), companion = in.text();
  std::vector<ForeignSurface> surfaces;
  try {
    surfaces = reader.program == ForeignProgram::vtk ? read_with_vtk(reader, bytes)
                                                     : read_with_assimp(reader, bytes, companion);
  } catch (const std::exception& e) {
    // Whatever a reader throws, std::bad_alloc for a hostile count too, the bytes are at fault.
    if (const auto* known = dynamic_cast<const Error*>(&e)) throw *known;
    throw Error(ExitCode::bad_input, "", "", std::string("damaged: the reader gave up: ") + e.what());
  }
  for (const ForeignSurface& s : surfaces) {
    check(s);
    const std::string out = packed(s);
    request.write(out.data(), out.size());
  }
});

}  // namespace

std::vector<ForeignSurface> read_foreign(const ForeignReader& reader, std::string_view bytes,
                                         std::string_view companion, const ChildLimits& limits,
                                         const Progress& progress) {
  std::string request;
  request.reserve(bytes.size() + companion.size() + 32);
  put(request, reader);
  put_text(request, bytes);
  put_text(request, companion);
  const ChildResult result = run_child(worker_name, request, limits, progress);
  std::vector<ForeignSurface> surfaces;
  for (Unpacker in(result.bytes()); !in.done();) {
    surfaces.push_back(unpacked(in));
    check(surfaces.back());
  }
  return surfaces;
}

ChildLimits foreign_limits(std::size_t bytes) {
  ChildLimits limits;
  // Text becomes a structure of some hundred bytes a corner in assimp.
  limits.memory_bytes = (std::uint64_t{2} << 30) + 64 * std::uint64_t(bytes);
  limits.cpu_s = 20 + double(bytes) / 1e6;
  limits.wall_s = 3 * limits.cpu_s;
  return limits;
}

}  // namespace trephine
