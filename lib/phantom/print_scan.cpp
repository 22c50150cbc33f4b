// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/print_scan.h"

#include <algorithm>
#include <list>

#include "base/error.h"
#include "base/parallel.h"
#include "grid/sample.h"
#include "mask/bits.h"
#include "meshio/read_mesh.h"
#include "phantom/body_scan.h"
#include "surface/bounds.h"
#include "voxel/decode.h"
#include "voxel/voxelize.h"

namespace trephine::phantom {
namespace {

constexpr double raster_mm = 0.7, margin_mm = 4;
constexpr double air_hu = -1000, water_hu = 0, catheter_hu = 1500, lumen_ratio = 0.48;
constexpr double closed_mm = 1.5;  ///< clefts between the parts, through which no gel runs

double to_segment_mm(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double t = std::clamp(dot(p - a, d) / std::max(1e-9, dot(d, d)), 0.0, 1.0);
  return norm(p - a - d * t);
}

// The space in the head that no way leads to from outside.
mask::BitMask gel_of(const voxel::HapticDecoder& decoder, const grid::Lattice& l) {
  mask::BitMask open = mask::closed(mask::make_mask(l,
                                                    [&](int j, int k, std::uint8_t* row) {
                                                      for (int i = 0; i < l.size[0]; ++i)
                                                        row[i] = decoder.shape_at(i, j, k) != 0;
                                                    }),
                                    closed_mm);
  const mask::Components spaces = mask::components(open.invert());
  std::vector<char> inner(spaces.list.size(), 0);
  for (std::size_t c = 0; c < inner.size(); ++c) inner[c] = spaces.list[c].faces == 0;
  return mask::dilated(mask::largest(mask::components(mask::select(spaces, inner))), closed_mm + raster_mm);
}

/// The parts as HU on a raster, in their frame.
grid::Grid<float> hu_of(const std::vector<ScannedPart>& parts, const PrintedParams& params, const Progress& progress) {
  surface::Bounds box;
  std::vector<voxel::VoxelizeShape> shapes;
  int core = 0;
  for (const ScannedPart& p : parts) {
    const surface::Bounds its = surface::bounds_of(*p.mesh);
    surface::include(box, its.min_mm);
    surface::include(box, its.max_mm);
    voxel::VoxelizeShape shape;
    shape.name = p.name;
    std::replace(shape.name.begin(), shape.name.end(), '-', '_');
    shape.surface = p.mesh;
    shapes.push_back(shape);
    if (p.name == "ventricles") core = int(shapes.size());
  }
  voxel::VoxelizeParams raster;
  raster.spacing_mm = {raster_mm, raster_mm, raster_mm};
  for (int a = 0; a < 3; ++a) box.min_mm[a] -= margin_mm, box.max_mm[a] += margin_mm;
  const grid::Lattice l = voxel::haptic_lattice(box, Mat3(), {}, raster);
  const voxel::HapticVolume volume = voxel::voxelize(l, shapes, progress.part(0, 0.8)).value;
  const voxel::HapticDecoder decoder(volume);
  const mask::BitMask gel = gel_of(decoder, l);
  grid::Grid<float> hu(l);
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          double sum = 0, left = 1;
          for (int n = 1; n <= int(shapes.size()); ++n) {
            const double share = std::min(left, decoder.occupancy(n, i, j, k));
            sum += share * (n == core ? water_hu : params.plastic_hu);
            left -= share;
          }
          hu.at(i, j, k) = float(sum + left * (gel.get(i, j, k) ? params.gel_hu : air_hu));
        }
  });
  return hu;
}

}  // namespace

Scan scan_print(const print::PrintRecord& record, const std::vector<ScannedPart>& parts, const PrintedParams& params,
                const ScanParams& scan, std::uint64_t seed, const Progress& progress) {
  const grid::Grid<float> hu = hu_of(parts, params, progress.part(0, 0.5));
  const itk::LinearMap to_case = itk::inverse(head_pose(scan)), to_print = print::map_of(record.case_to_print);
  const auto vec = [](const std::array<double, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
  const Vec3 entry = vec(params.entry_mm), tip = vec(params.tip_mm), way = normalized(tip - entry);
  const double radius = params.catheter_mm / 2;
  const Vec3 end = tip - way * radius;  // a rounded end
  const auto cover = [](double off, double width) { return std::clamp(0.5 - off / width, 0.0, 1.0); };
  return scan_body(
      [&](Vec3 lps, double width) {
        const Vec3 p = to_case(lps);
        double value = grid::sampled(hu, hu.to_index(to_print(p)), grid::value_beyond(air_hu));
        if (!params.has_catheter()) return value;
        const double along = dot(p - entry, way);
        if (params.hole_mm > 0 && along < 14) {
          const double off = norm(p - entry - way * along) - params.hole_mm / 2;
          if (value > params.gel_hu) value += (params.gel_hu - value) * cover(off, width);
        }
        const double off = to_segment_mm(p, entry - way * 15, end) - radius;
        value += (catheter_hu - value) * cover(off, width);
        return value + (water_hu - value) * cover(off + lumen_ratio * params.catheter_mm / 2, width);
      },
      scan, seed, progress.part(0.5, 1));
}

Scan scan_print(const PrintedParams& params, const ScanParams& scan, std::uint64_t seed, const Progress& progress) {
  const std::filesystem::path file = params.print;
  const print::PrintRecord record = print::read_print(file);
  std::list<surface::TriMesh> meshes;
  std::vector<ScannedPart> parts;
  for (const print::PrintPart& p : record.parts) {
    if (p.file.find('/') != std::string::npos)
      throw Error(ExitCode::bad_input, file.string(), "parts.file", "must be a file beside it");
    meshes.push_back(meshio::read_mesh_file(file.parent_path() / p.file, {}, progress).value);
    parts.push_back({p.name, &meshes.back()});
  }
  return scan_print(record, parts, params, scan, seed, progress);
}

}  // namespace trephine::phantom
