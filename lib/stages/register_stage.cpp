// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.h"
#include "base/refusal.h"
#include "itk/registration.h"
#include "itk/same_place.h"
#include "itk/transform_file.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType register_stage() {
  StageType s;
  s.name = "register";
  s.version = 6;
  s.place = StagePlace::scene;  // a case names its further scans, and a recipe's steps read them by `scan`
  s.typical.base_s = 12;
  s.summary = "lays a second scan of the patient (MR, angiography, another CT) on the CT";
  s.description =
      "Registers the second scan onto the CT by Mattes' mutual information, from coarse voxels to fine ones, and gives "
      "it on the CT's voxels. The registration checks itself: it is done again from three places 8 mm and 8 degrees "
      "off and in the other direction, and compared with an affine one. A result that is doubtful is refused with exit "
      "code 80 and the figures that say why. A transform that is given is held against the images. Offsets up to 30 mm "
      "and 20 degrees are within reach; for others give a "
      "transform to begin with.";
  s.examples = {"trephine register head.nrrd mr.nrrd --transform mr.tfm --picture check.png --output mr_on_ct.nrrd"};
  s.ports = {
      port("volume", DataKind::volume).from(From::original_scan).help("CT volume in HU, which stays"),
      port("moving", DataKind::volume).from(From::further_scan).help("the second scan"),
      port("within", DataKind::field).optional().help("an anatomy of the CT; places outside of it are not compared")};
  s.output = DataKind::volume;
  s.declares<itk::RegistrationParams, itk::RegistrationFigures>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    const auto& r = result_as<itk::RegistrationFigures>(result);
    parts.made_of = {{"transform", r.transform}, {"turn_deg", r.turn_deg}};
    for (const auto& [name, value] : {std::pair{"spread_mm", r.spread_mm},
                                      {"inverse_mm", r.inverse_mm},
                                      {"overlap_ratio", r.overlap_ratio},
                                      {"margin_ratio", r.margin_ratio},
                                      {"scale_ratio", r.scale_ratio},
                                      {"bone_ratio", r.bone_ratio}})
      if (value) parts.made_of.emplace_back(name, *value);
    if (r.another_patient.value_or(false)) parts.doubted_scale_ratio = r.scale_ratio;
  };
  s.run = [](const AnyParams& any, const StageInputs& in, const Progress& progress) {
    const auto& params = any.as<itk::RegistrationParams>();
    std::optional<itk::LinearMap> initial;
    if (!params.initial.empty()) initial = itk::read_transform(params.initial);
    const grid::HuVolume &fixed = *in.get<grid::HuVolume>("volume"), &moving = *in.get<grid::HuVolume>("moving");
    itk::Registration r =
        params.given.empty()
            ? itk::register_scans(fixed, moving, in.get<grid::Field>("within"), initial, params, progress.part(0, 0.9))
            : itk::given_registration(fixed, moving, itk::read_transform(params.given), params);
    const auto refuse = [&r](const std::string& field, const std::string& what, const Remedy& remedy) {
      throw itk::DoubtfulRegistration(refusal(field, what, remedy), r.map);
    };
    // A given transform that moves nothing says that both are reconstructions of one scan: that can be checked.
    if (!params.given.empty() && itk::is_identity(r.map) && params.moving == itk::MovingValues::hu) {
      const double bone = itk::bone_ratio(fixed, moving, progress.part(0, 0.9));
      r.figures.bone_ratio = bone;
      if (!(bone >= itk::min_bone_ratio))
        refuse("given",
               fmt::format("moves nothing, and the bones of the two scans lie upon each other by {:.2f}, at least {} "
                           "of two reconstructions of one scan",
                           bone, itk::min_bone_ratio),
               {"leave `given` out, and they are registered"});
    }
    const bool by_bones = itk::is_identity(r.map) && params.moving == itk::MovingValues::hu;
    if (!params.given.empty() && r.doubts.empty() && !by_bones) {
      // The images are registered all the same, and say how far the given transform lies from their own.
      itk::Registration own =
          itk::register_scans(fixed, moving, in.get<grid::Field>("within"), r.map, params, progress.part(0, 0.9));
      if (own.doubts.empty()) {
        r.figures.scale_ratio = own.figures.scale_ratio;
        r.figures.another_patient = own.figures.another_patient;
        r.warnings.insert(r.warnings.end(), own.warnings.begin(), own.warnings.end());
        const double apart = itk::apart_mm(fixed, r.map, own.map);
        r.figures.given_apart_mm = apart;
        if (!(apart <= params.largest_given_mm))
          refuse("given",
                 fmt::format("the transform leads up to {:.2f} mm away from where the images lie best upon each other, "
                             "at most {} (largest_given_mm)",
                             apart, params.largest_given_mm),
                 {"leave `given` out, and they are registered; or, where the picture shows that it is right, raise "
                  "`largest_given_mm`"});
        r.warnings.push_back({"given_transform_agrees",
                              "the transform was given; the images agree with it within {apart_mm:.2f} mm",
                              {{"apart_mm", apart}}});
      } else {
        r.warnings.push_back({"given_transform_unchecked",
                              "the transform was given, and the images cannot say whether it is right, so look at its "
                              "picture: {why}",
                              {{"why", own.doubts}}});
      }
    }
    if (!r.doubts.empty())
      refuse("", "the registration is doubtful: " + r.doubts,
             {"look at its picture; give an `initial` transform from another program to begin with, or `within` an "
              "anatomy that both scans show"});
    const float outside = params.moving == itk::MovingValues::hu ? -1000.0f : 0.0f;
    return stage_outcome(Outcome<grid::HuVolume, itk::RegistrationFigures>{
        itk::resample_onto(moving, grid::lattice_of(fixed), r.map, outside, progress.part(0.9, 1)),
        std::move(r.figures), std::move(r.warnings)});
  };
  return s;
}

}  // namespace trephine::stages
