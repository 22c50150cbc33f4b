// SPDX-License-Identifier: GPL-3.0-or-later
// The spine on the scanner of the head, and its truth.
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "phantom/body_scan.h"
#include "phantom/spine_parts.h"

namespace trephine::phantom {
namespace {

using Json = nlohmann::ordered_json;

constexpr double vertebra_reach_mm = 30;  // before and behind the middle

Json to_json(Vec3 v) { return {v.x, v.y, v.z}; }

// From the scanner's frame to the spine's: the middle of the default block is the spine's middle.
Vec3 offset_mm() { return default_centre_mm() - Vec3{0, 10, 0}; }

// As many vertebrae as the block is high, and one more: none ends in it that a scan would show whole.
Spine spine_in(SpineParams spine, const std::vector<SlicePose>& slices, const ScanParams& p) {
  double reach = 0;
  const double columns = p.columns_count - 1, rows = p.rows_count - 1, pixel = pixel_spacing_mm(p);
  for (const SlicePose& s : slices)
    for (int n = 0; n < 4; ++n) {
      const Vec3 corner = s.origin_mm + s.row * (n & 1 ? columns * pixel : 0) + s.column * (n & 2 ? rows * pixel : 0);
      reach = std::max(reach, std::abs(corner.z - offset_mm().z));
    }
  spine.vertebrae_count = 2 * int(std::ceil(reach / spine.pitch_mm)) + 1;
  return Spine(spine);
}

// Whether a vertebra lies between the first and the last slice, before and behind its middle, with as much beside it as
// its neighbours leave.
bool whole(const Spine& spine, int vertebra, const std::vector<SlicePose>& slices) {
  double low = 1e9, high = -1e9;
  for (const SlicePose& s : slices) {
    const Vec3 normal = cross(s.row, s.column);
    double ends[2];  // where the slice, which may be tilted, lies there
    for (const int side : {0, 1}) {
      const Vec3 at = offset_mm() + Vec3{0, side ? vertebra_reach_mm : -vertebra_reach_mm, 0};
      ends[side] = (dot(normal, s.origin_mm) - normal.x * at.x - normal.y * at.y) / normal.z;
    }
    low = std::min(low, std::max(ends[0], ends[1]));
    high = std::max(high, std::min(ends[0], ends[1]));
  }
  const double z = spine.level(vertebra) + offset_mm().z, half = 0.5 * spine.params().pitch_mm;
  return z - half >= low && z + half <= high;
}

}  // namespace

Scan scan(const SpineParams& of, const ScanParams& params, std::uint64_t seed, const Progress& progress) {
  const Spine spine = spine_in(of, slice_poses(params), params);
  return scan_body([&](Vec3 p, double width_mm) { return hu_of(spine, p - offset_mm(), width_mm); }, params, seed,
                   progress);
}

std::int64_t write_truth(const std::filesystem::path& folder, const SpineParams& of, const Scan& scan,
                         const ScanParams& params, bool labels) {
  make_output_folder(folder);
  const Spine spine = spine_in(of, scan.slices, params);
  Json json;
  json["trephine_spine_truth"] = 1;
  json["frame"] = "DICOM patient LPS, mm";
  const ParameterSet& declared = parameters_of<SpineParams>();
  for (const Parameter& p : declared.parameters) json["spine"][p.name] = std::get<double>(p.get(&of));
  json["pedicles"] = Json::array();
  int first = -1;
  for (const Spine::Pedicle& p : spine.pedicles()) {
    if (!whole(spine, p.vertebra, scan.slices)) continue;
    if (first < 0) first = p.vertebra;
    double behind = 0, before = 0;
    while (spine.bone(p.middle_mm - p.forwards * behind) > 0) behind += 0.1;
    while (spine.bone(p.middle_mm + p.forwards * before) > 0) before += 0.1;
    const Vec3 entry = p.middle_mm - p.forwards * behind, target = entry + p.forwards * (0.75 * (behind + before));
    json["pedicles"].push_back(
        {{"name", "pedicle_" + std::to_string(p.vertebra - first + 1) + (p.left ? "_left" : "_right")},
         {"entry_mm", to_json(entry + offset_mm())},
         {"target_mm", to_json(target + offset_mm())},
         {"middle_mm", to_json(p.middle_mm + offset_mm())},
         {"half_width_mm", p.half_width_mm}});
  }
  if (labels && has_lattice(params)) {
    grid::Mask mask(lattice_of(scan));
    parallel_for(0, mask.size[2], 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < to; ++k)
        for (int j = 0; j < mask.size[1]; ++j)
          for (int i = 0; i < mask.size[0]; ++i) {
            const Vec3 p = mask.to_world_mm({double(i), double(j), double(k)}) - offset_mm();
            mask.at(i, j, k) = spine.bone(p) > 0 ? 2 : spine.canal(p) > 0 ? 3 : spine.skin(p) > 0 ? 1 : 0;
          }
    });
    grid::write_nrrd(folder / "labels.nrrd", mask);
  }
  write_file(folder / "truth.json", json.dump(1) + "\n");
  return static_cast<std::int64_t>(json["pedicles"].size());
}

}  // namespace trephine::phantom
