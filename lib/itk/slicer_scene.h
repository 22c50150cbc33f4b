// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace trephine::itk {

/// A scalar volume of a 3D Slicer scene (.mrml), in the order of the file. Its name in the scene is not kept: it may be
/// a patient's.
struct SceneVolume {
  std::string file;          ///< relative to the scene, '/' between folders
  bool transformed = false;  ///< it lies under a transform that is not part of its file
};

/// Reads the XML of a scene: nodes Volume and the storage nodes that they name. Throws Error 65, field "scene": no
/// scene, damaged, a volume of several files or of a file that lies elsewhere (an absolute path, "..").
std::vector<SceneVolume> scene_volumes(std::string_view mrml);

}  // namespace trephine::itk
