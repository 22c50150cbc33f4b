// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <list>
#include <string>
#include <vector>

#include "base/progress.h"
#include "cases/load_case.h"
#include "surface/trimesh.h"

namespace trephine::tools {

/// An anatomy of a case with its surface: the displayed one, or that of the haptic volume, which displays it.
struct ShownShape {
  std::string name;
  std::array<double, 3> colour_rgb;
  double opacity = 1;
  const surface::TriMesh* mesh = nullptr;
  bool is_felt = false;  ///< its surface is the haptic volume's
};

/// The anatomies of a case that are wanted; none named: all. The case must outlive it. Throws Error 64 for a name that
/// is none of them.
class CaseShapes {
 public:
  CaseShapes(const cases::LoadedCase& loaded, const std::vector<std::string>& wanted, const Progress& progress);
  const std::vector<ShownShape>& all() const { return shown_; }

 private:
  std::vector<ShownShape> shown_;
  std::list<surface::TriMesh> felt_;
};

}  // namespace trephine::tools
