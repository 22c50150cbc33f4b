// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/zones.h"

#include "stages/cranial_cavity_of.h"

namespace trephine::stages {
StageType zone_stage() {
  StageType s;
  s.name = "zone";
  s.version = 11;
  s.typical.base_s = 0.1;
  s.typical.per_million_voxels_s = 0.008;
  s.typical.surface_million = 0.04;
  s.summary = "makes a zone of a head that no tool should enter";
  s.description =
      "Gives a field in mm that is positive inside the dura, a slab in the midline, the superior sagittal sinus, the "
      "third ventricle or the brainstem. A CT shows inner table and ventricles; the rest is a template's, which is "
      "registered to them. As an anatomy of a recipe it is a zone that burr holes can be held clear of, and by which a "
      "lesson is scored where the anatomy is named sagittal_sinus, third_ventricle or brainstem.";
  s.examples = {
      "trephine zone head.nrrd --what sagittal_sinus --skull skull.nrrd --ventricles ventricles.nrrd --output "
      "sinus.nrrd",
      "trephine zone head.nrrd --what dura --skull skull.nrrd --output dura.nrrd"};
  s.ports = {port("volume", DataKind::volume).help("CT volume in HU"),
             port("skull", DataKind::field)
                 .optional()
                 .help("the skull that encloses the brain; without it, bone is every voxel above 226 HU"),
             port("ventricles", DataKind::field)
                 .optional()
                 .needed_where(
                     [](const AnyParams& p) { return p.as<place::ZoneParams>().what == place::Zone::third_ventricle; })
                 .help("the ventricles: by them the template lies better")};
  s.output = DataKind::field;
  s.declares<place::ZoneParams, place::ZoneResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    place::ZoneShapes shapes;
    shapes.skull = in.get<grid::Field>("skull");
    shapes.ventricles = in.get<grid::Field>("ventricles");
    shapes.volume = in.get<grid::HuVolume>("volume");
    const auto cavity = cranial_cavity_of(in, progress.part(0, 0.3));
    shapes.place = [&](bool with_ventricles, const Progress& rest) {
      const grid::Field* ventricles = with_ventricles ? shapes.ventricles : nullptr;
      std::vector<std::string> of{"volume", "skull"};
      if (ventricles) of.push_back("ventricles");
      return *in.once<place::HeadPlace>("place in the cranial cavity", of, rest, [&] {
        return std::make_shared<const place::HeadPlace>(place::place_in_cavity(cavity->value, ventricles, rest));
      });
    };
    auto made = place::find_zone(cavity->value, shapes, params.as<place::ZoneParams>(), progress.part(0.3, 1));
    made.result.cranial_cavity_ml = cavity->result.cranial_cavity_ml;
    made.warnings.insert(made.warnings.begin(), cavity->warnings.begin(), cavity->warnings.end());
    return stage_outcome(std::move(made));
  };
  return s;
}

}  // namespace trephine::stages
