// SPDX-License-Identifier: GPL-3.0-or-later
// The chest on the scanner of the head, and its truth.
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "phantom/body_scan.h"
#include "phantom/chest.h"

namespace trephine::phantom {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(Vec3 v) { return {v.x, v.y, v.z}; }

// From the scanner's frame to the chest's.
Vec3 offset_mm() { return default_centre_mm() - Vec3{0, -5, -5}; }

Json line_of(const std::vector<Vec3>& points) {
  Json all = Json::array();
  for (const Vec3& p : points) all.push_back(to_json(p + offset_mm()));
  return all;
}

}  // namespace

Scan scan(const ChestParams& of, const ScanParams& params, std::uint64_t seed, const Progress& progress) {
  const Chest chest(of);
  return scan_body([&](Vec3 p, double width_mm) { return chest.hu(p - offset_mm(), width_mm); }, params, seed,
                   progress);
}

std::int64_t write_truth(const std::filesystem::path& folder, const ChestParams& of, const Scan& scan,
                         const ScanParams& params, bool labels) {
  make_output_folder(folder);
  const Chest chest(of);
  Json json;
  json["trephine_chest_truth"] = 1;
  json["frame"] = "DICOM patient LPS, mm";
  for (const Parameter& p : parameters_of<ChestParams>().parameters)
    json["chest"][p.name] = std::get<double>(p.get(&of));
  json["notch_mm"] = to_json(chest.notch_mm() + offset_mm());
  for (const bool left : {false, true})
    json[left ? "left" : "right"] = {{"clavicle_mm", line_of(chest.clavicle_line(left))},
                                     {"vein_mm", line_of(chest.vein_line(left))},
                                     {"artery_mm", line_of(chest.artery_line(left))}};
  if (labels && has_lattice(params)) {
    grid::Mask mask(lattice_of(scan));
    parallel_for(0, mask.size[2], 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < to; ++k)
        for (int j = 0; j < mask.size[1]; ++j)
          for (int i = 0; i < mask.size[0]; ++i) {
            const Vec3 p = mask.to_world_mm({double(i), double(j), double(k)}) - offset_mm();
            mask.at(i, j, k) = !(chest.skin(p) > 0)      ? 0
                               : chest.clavicle(p) > 0   ? 2
                               : chest.other_bone(p) > 0 ? 3
                               : chest.vein(p) > 0       ? 4
                               : chest.artery(p) > 0     ? 5
                               : chest.lung(p) > 0       ? 6
                                                         : 1;
          }
    });
    grid::write_nrrd(folder / "labels.nrrd", mask);
  }
  write_file(folder / "truth.json", json.dump(1) + "\n");
  return 6;
}

}  // namespace trephine::phantom
