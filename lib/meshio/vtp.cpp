// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/vtp.h"

#include <array>
#include <string>
#include <string_view>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "meshio/formats.h"
#include "meshio/vtp_encode.h"
#include "meshio/vtp_parse.h"

namespace trephine::meshio {
namespace {

// The last bytes of a file that this program wrote: a comment behind the root element with the checksum of every byte
// before it. VTK does not read that far, and a program that rewrites the file drops the comment.
constexpr std::string_view trailer_begin = "<!-- trephine sha256 ";
constexpr std::string_view trailer_end = " -->\n";
constexpr std::size_t trailer_size = trailer_begin.size() + 64 + trailer_end.size();

std::string trailer_of(std::string_view bytes) {
  return std::string(trailer_begin) + sha256_of_bytes(bytes) + std::string(trailer_end);
}

/// A file without our checksum says nothing of itself.
bool contradicts_its_checksum(std::string_view bytes) {
  if (bytes.size() < trailer_size) return false;
  const std::string_view trailer = bytes.substr(bytes.size() - trailer_size);
  return trailer.substr(0, trailer_begin.size()) == trailer_begin &&
         trailer != trailer_of(bytes.substr(0, bytes.size() - trailer_size));
}

const ChildWorker parse_worker("vtp-parse", [](ChildRequest& request) {
  const surface::TriMesh mesh = parse_vtp(std::string(request.request()));
  const auto send = [&](const auto& array) {  // one after the other: there is a copy of one only
    MessageWriter out;
    out.array(array);
    request.write(out.bytes());
  };
  send(std::array<Vec3, 1>{mesh.origin_mm});
  send(mesh.points_mm);
  send(mesh.triangles);
  send(mesh.normals);
});

surface::TriMesh parse_in_child(std::string_view bytes) {
  ChildLimits limits;
  limits.memory_bytes = (std::uint64_t{1} << 30) + 16 * std::uint64_t(bytes.size());
  const ChildResult result = [&] {
    try {
      return run_child("vtp-parse", bytes, limits);
    } catch (const Error& e) {  // a fault of the reader, and a file that no user can do anything with
      if (e.cause() != Cause::child_died) throw;
      throw Error(ExitCode::bad_input, "", "", "damaged: VTK's reader died of it; write the file again");
    }
  }();
  MessageReader in("vtp-parse", result.bytes());
  surface::TriMesh mesh;
  mesh.origin_mm = in.array<Vec3>().at(0);
  mesh.points_mm = in.array<Vec3>();
  mesh.triangles = in.array<std::array<std::uint32_t, 3>>();
  mesh.normals = in.array<Vec3>();
  return mesh;
}

bool ends_as_xml(std::string_view bytes) {
  const std::string_view tail = bytes.substr(bytes.size() < 4096 ? 0 : bytes.size() - 4096);
  return tail.find("</VTKFile>") != std::string_view::npos;
}

}  // namespace

std::string encode_vtp(const surface::TriMesh& mesh, const VtpExtras& extras) {
  std::string bytes;
  formats().encode_vtp(&mesh, &extras, &bytes);
  bytes += trailer_of(bytes);
  return bytes;
}

surface::TriMesh parse_vtp(std::string&& bytes) {
  surface::TriMesh mesh;
  formats().parse_vtp(&bytes, &mesh);
  surface::check_mesh(mesh);
  return mesh;
}

void write_vtp(const std::filesystem::path& file, const surface::TriMesh& mesh) {
  with_field("surface", [&] { surface::check_mesh(mesh); });
  write_file(file, with_file(file.string(), [&] { return encode_vtp(mesh); }));
}

surface::TriMesh read_vtp(const std::filesystem::path& file) {
  std::string bytes;
  {
    const std::vector<char> read = read_file(file);
    bytes.assign(read.begin(), read.end());
  }
  try {
    if (contradicts_its_checksum(bytes)) throw Error(ExitCode::bad_input, "", "", "damaged: its checksum does not fit");
    if (bytes.empty()) throw Error(ExitCode::bad_input, "", "", "the file is empty");
    if (!ends_as_xml(bytes)) throw Error(ExitCode::bad_input, "", "", "no VTK XML PolyData file, or cut short");
    return parse_in_child(bytes);
  } catch (Error& e) {
    e.in_file(file.string());
    throw;
  }
}

}  // namespace trephine::meshio
