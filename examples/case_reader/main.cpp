// SPDX-License-Identifier: GPL-3.0-or-later
// case_reader CASE: loads a case, lists its surfaces, and pushes a point through the haptic volume.
#include <algorithm>
#include <iostream>

#include "base/error.h"
#include "cases/load_case.h"
#include "voxel/decode.h"

using namespace trephine;

// What a tool meets on its way: each shape whose surface (occupancy 1/2) the point crosses.
void walk(const cases::LoadedCase& c, Vec3 from_mm, Vec3 direction, double length_mm) {
  const voxel::HapticDecoder decoder(c.haptic);
  const Vec3 spacing = c.haptic.voxels.spacing_mm;
  const double step = std::min({spacing.x, spacing.y, spacing.z}) / 4;
  for (const cases::CaseShape& shape : c.manifest.haptic.shapes) {
    bool inside = false;
    double before = 0;
    for (double way = 0; way <= length_mm; way += step) {
      const double occupancy = decoder.trilinear(shape.number, from_mm + direction * way);
      if ((occupancy >= 0.5) != inside) {
        inside = !inside;
        const double at = way - step * (occupancy - 0.5) / (occupancy - before);
        const cases::CaseFace& face = inside ? shape.material.front : shape.material.back;
        std::cout << "  " << at << " mm: " << (inside ? "into " : "out of ") << shape.name << " ("
                  << shape.material.name << "), ";
        if (face.touchable)
          std::cout << face.stiffness_n_per_mm << " N/mm\n";
        else
          std::cout << "not felt\n";
      }
      before = occupancy;
    }
  }
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: case_reader CASE\n";
    return 64;
  }
  try {
    const cases::LoadedCase c = cases::load_case(argv[1]);
    for (const cases::CaseAnatomy& a : c.manifest.anatomies)
      if (const surface::TriMesh* surface = c.find_surface(a.name))
        std::cout << a.name << ": " << surface->triangles.size() << " triangles\n";
    if (!c.has_haptic()) return 0;
    // Along the first burr hole, or else from the patient's left through the middle.
    Vec3 direction{-1, 0, 0}, entry = c.manifest.center_mm + Vec3{100, 0, 0};
    if (!c.manifest.burr_holes.empty()) {
      direction = c.manifest.burr_holes[0].direction;
      entry = c.manifest.burr_holes[0].position_mm;
    }
    const Vec3 start = entry - direction * 20;
    std::cout << "from " << start.x << ", " << start.y << ", " << start.z << " mm (LPS), 20 mm before the entry:\n";
    walk(c, start, direction, 240);
  } catch (const Error& e) {
    std::cerr << e.line("case_reader") << "\n";
    return static_cast<int>(e.code());
  }
}
