// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "base/error.h"
#include "base/params.h"
#include "base/progress.h"
#include "base/warning.h"
#include "grid/grid.h"
#include "itk/transform.h"

namespace trephine::itk {

enum class RegistrationKind { rigid, affine };
enum class MovingValues { hu, any };

struct RegistrationParams {
  RegistrationKind kind = RegistrationKind::rigid;
  MovingValues moving = MovingValues::any;
  std::string initial, given;
  double lower_hu = -300, upper_hu = 300;
  double finest_mm = 1.5;
  int bins_count = 32, samples_count = 60000;
  double largest_spread_mm = 1, largest_inverse_mm = 0.25, largest_given_mm = 1;
  double least_overlap_ratio = 0.5, least_margin_ratio = 0.15, largest_scale_ratio = 0.04;

  template <class V>
  static void describe(V& v) {
    using P = RegistrationParams;
    v.choice(&P::kind, "kind", {{"rigid", RegistrationKind::rigid}, {"affine", RegistrationKind::affine}},
             "rigid for two scans of one patient; affine, which may also stretch, for another patient or a template.");
    v.choice(
        &P::moving, "moving_values", {{"any", MovingValues::any}, {"hu", MovingValues::hu}},
        "Values of the second scan: HU, which are compared within lower_hu and upper_hu, or any (MR, angiography), "
        "of which the middle 99 % are.");
    v.text(&P::initial, "initial",
           "Transform to begin with (.tfm or .h5, from the CT to the second scan); empty: the centres of mass are laid "
           "on each "
           "other and several turns are tried.")
        .names("file");
    v.text(&P::given, "given",
           "Transform to take instead of registering (.tfm or .h5, from the CT to the second scan), made and looked at "
           "in "
           "another program. It must not stretch, and is held against the images (largest_given_mm).")
        .names("file");
    v.number(&P::lower_hu, "lower_hu", Range{-1024, 30000}, "HU below this count as this: air and foam are one.");
    v.number(&P::upper_hu, "upper_hu", Range{-1024, 30000}, "HU above this count as this: bone is one.");
    v.number(&P::finest_mm, "finest_mm", Range{0.5, 4}, "Voxels of the last step; those before it have 8 and 4 mm.");
    v.integer(&P::bins_count, "bins_count", Range{8, 128}, "Classes of values of each scan in the joint histogram.");
    v.integer(&P::samples_count, "samples_count", Range{2000, 2000000}, "Places that the last step compares.");
    v.number(&P::largest_spread_mm, "largest_spread_mm", Range{0.01, 100},
             "How far apart registrations may end that begin 8 mm and 8 degrees off the result.");
    v.number(
        &P::largest_inverse_mm, "largest_inverse_mm", Range{0.01, 100},
        "How far the registration of the CT onto the second scan may be from the inverse, with voxels of up to 2 mm; "
        "with coarser ones in proportion to their longest side. Another patient's head, or a mirrored one, lies "
        "above.");
    v.number(
        &P::largest_given_mm, "largest_given_mm", Range{0.01, 100},
        "How far a given transform may lead from where the images themselves lie best upon each other, anywhere in "
        "the body.");
    v.number(&P::least_overlap_ratio, "least_overlap_ratio", Range{0.3, 1},
             "Share of the head's samples in the CT that must lie within the second scan.");
    v.number(&P::least_margin_ratio, "least_margin_ratio", Range{0, 1},
             "By how much of itself the mutual information must exceed that of places 20 mm off.");
    v.number(&P::largest_scale_ratio, "largest_scale_ratio", Range{0, 1},
             "Of a rigid registration: how much an affine one may stretch or shrink where it goes on from there; more "
             "says that the two are not one patient, or that a scan's voxels have another size than it says.");
  }
};

/// The figures of a registration; those that a given transform has not been measured for are missing.
struct RegistrationFigures {
  std::vector<double> transform;
  double turn_deg = 0;
  std::optional<double> information_nats, spread_mm, inverse_mm, overlap_ratio, margin_ratio, bone_ratio, scale_ratio;
  std::optional<bool> another_patient;  ///< the limits are kept, but two scans of one head usually need less stretching
  std::optional<double> given_apart_mm;
  template <class V>
  static void describe(V& v) {
    using P = RegistrationFigures;
    v.numbers(&P::transform, "transform", "Rows of the matrix from the CT to the second scan, each with its offset.");
    v.number(&P::turn_deg, "turn_deg", Range{}, "Angle by which it turns.");
    v.number(&P::information_nats, "information_nats", "Mutual information.");
    v.number(&P::spread_mm, "spread_mm", "How far apart registrations end that begin off the result.");
    v.number(&P::inverse_mm, "inverse_mm", "How far the registration in the other direction is from the inverse.");
    v.number(&P::overlap_ratio, "overlap_ratio", "Share of the CT's body that lies in the second scan.");
    v.number(&P::margin_ratio, "margin_ratio", "By how much the information exceeds that of places 20 mm off.");
    v.number(&P::bone_ratio, "bone_ratio", "How far the bones of two reconstructions lie upon each other.");
    v.number(&P::scale_ratio, "scale_ratio", "How much an affine registration would still stretch.");
    v.flag(&P::another_patient, "another_patient", "Whether that is more than two scans of one head usually need.");
    v.number(&P::given_apart_mm, "given_apart_mm", "How far a given transform leads from the images' own.");
  }
};

struct Registration {
  LinearMap map;       ///< from a place in the fixed scan to the moving one
  std::string doubts;  ///< why the result must not be used; empty where the self-check passed
  RegistrationFigures figures;
  Warnings warnings;
};

/// A registration that must not be used; the map is for a picture of it.
class DoubtfulRegistration : public Error {
 public:
  DoubtfulRegistration(const Error& error, const LinearMap& map) : Error(error), map_(map) {}
  const LinearMap& map() const { return map_; }

 private:
  LinearMap map_;
};

/// Registers the moving scan onto the fixed one, a CT, by Mattes' mutual information [Mattes2003] as ITK computes it,
/// on voxels of 8, 4 and finest_mm. It begins at the centres of mass and tries turns of 20 degrees and shifts of 40 mm,
/// so offsets up to 30 mm and 20 degrees are within its reach, and any if `initial` is near. Samples lie in and 16 mm
/// around the body (and, where `within` is given, only where it is positive). Runs in trephine-itk (itk_child.h), whose
/// metric works with one work unit each; several registrations run beside each other, so the bytes are the same for
/// every number of threads.
///
/// The result checks itself: three starts 8 mm and 8 degrees off, the other direction, overlap, the metric's margin,
/// and what an affine registration would still stretch. Where a limit of params is not kept, `doubts` says which; the
/// caller decides (register exits with 80). Warns where another_patient holds.
///
/// Throws Error 64 where lower_hu is not below upper_hu; 65 where a scan is empty of contrast, has a voxel that is not
/// finite, or is smaller than 32 mm along an axis; as itk_child::run.
Registration register_scans(const grid::HuVolume& fixed, const grid::HuVolume& moving, const grid::Field* within,
                            const std::optional<LinearMap>& initial, const RegistrationParams& params,
                            const Progress& progress = {});

/// Takes the map for the registration's result, with the share of the CT's body (above -300 HU) that lies in
/// the moving scan; doubts where that is less than least_overlap_ratio. (Whether the images agree is the caller's to
/// check: apart_mm, bone_ratio.) Throws Error 65 where the kind is rigid and the
/// map stretches by more than 1e-4.
Registration given_registration(const grid::HuVolume& fixed, const grid::HuVolume& moving, const LinearMap& map,
                                const RegistrationParams& params);

/// The moving scan on the fixed one's voxels: trilinear, `outside` where it does not reach; whole numbers where the
/// moving scan has them.
grid::HuVolume resample_onto(const grid::HuVolume& moving, const grid::Lattice& fixed, const LinearMap& map,
                             float outside, const Progress& progress = {});

}  // namespace trephine::itk
