// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "ambf/image_stack.h"
#include "base/params.h"
#include "cases/load_case.h"

namespace trephine::ambf {

/// From where the camera looks at the patient.
enum class View { anterior, posterior, left, right, superior };

struct AdfParams {
  View ambf_view = View::anterior;
  template <class V>
  static void describe(V& v) {
    v.choice(&AdfParams::ambf_view, "ambf_view",
             {{"anterior", View::anterior},
              {"posterior", View::posterior},
              {"left", View::left},
              {"right", View::right},
              {"superior", View::superior}},
             "ambf: from which side of the patient the camera looks.");
  }
};

/// The files of a case for AMBF (github.com/WPI-AIM/ambf) with volumetric_drilling, in the words of its ADF
/// (version 1.0) and as that project's own files have them:
///
///   volume.yaml   VOLUME mastoidectomy_volume, the name by which the plugin finds what is drilled; BODY
///                 case_anatomical_origin, its parent: the patient's own frame, LPS in metres; a body for each
///                 landmark, target and burr hole; and `fiducial_locations`, the same places in the patient's frame
///   volume/       the picture stack (ambf/image_stack.h)
///   drills.yaml   the four burrs that the plugin knows (1, 2, 4 and 6 mm) and the body that the hand moves
///   world.yaml    main_camera and light1; launch.yaml names all of them
///   meshes/       burrs and marks, OBJ in mm (scale 0.001)
///
/// Lengths are metres (`conversion factor: 1.0`). A volume's frame is at its middle, with its axes along columns, rows
/// from the bottom, and slices; angles are those of rotations about the fixed axes x, y, z (roll, pitch, yaw). The
/// folder belongs into volumetric_drilling/ADF: shaders, floor, colours and input devices are that project's.
///
/// Throws Error 65 where the case has no haptic volume, or one of more than 2,048 voxels along an axis, which no
/// graphics card holds as a texture.
std::vector<meshio::ExportFile> encode_adf(const cases::LoadedCase& loaded, const AdfParams& params,
                                           const std::string& program);

/// The colours of the stack: drilled_rgb for what the case lets a tool remove, else the shape's own.
Palette palette_of(const cases::CaseManifest& manifest);

}  // namespace trephine::ambf
