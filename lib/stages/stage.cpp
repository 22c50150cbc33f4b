// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stage.h"

namespace trephine {

const char* to_text(DataKind kind) {
  switch (kind) {
    case DataKind::volume:
      return "volume";
    case DataKind::field:
      return "field";
    case DataKind::mesh:
      return "surface";
    case DataKind::haptic:
      return "haptic volume";
    case DataKind::cutters:
      return "list of cutters";
    case DataKind::landmarks:
      return "list of landmarks";
    case DataKind::nothing:
      return "report";
  }
  return "";
}

const Port* StageType::find_port(const std::string& port) const {
  for (const Port& p : ports)
    if (p.name == port) return &p;
  return nullptr;
}

const std::vector<StageType>& stage_types() {
  static const std::vector<StageType> types = {
      segment_stage(),  labels_stage(),   presegment_stage(), snake_stage(),    landmarks_stage(), canal_stage(),
      clavicle_stage(), vein_stage(),     contour_stage(),    decimate_stage(), smooth_stage(),    normals_stage(),
      repair_stage(),   simplify_stage(), anatomy_stage(),    remesh_stage(),   measure_stage()};
  return types;
}

const StageType* find_stage(const std::string& name) {
  for (const StageType& t : stage_types())
    if (t.name == name) return &t;
  return nullptr;
}

}  // namespace trephine
