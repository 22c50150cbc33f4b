// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "desk/open_case.h"
#include "segmentation/edit_list.h"
#include "segmentation/hand_edits.h"

namespace trephine::desk {

/// What a page watches before it is saved: a snake while it grows, or a shape as an edit would leave it. One at a time;
/// a newer one takes its place. Its memory is bounded by what EditSnake takes (40 million voxels). It may be called
/// from several threads, which wait for each other.
class LiveEdit {
 public:
  struct Now {
    int steps = 0;
    double change_mm = 0, volume_ml = 0;
  };
  /// The snake after that many steps. Where it is the one that was watched last, with as many steps or fewer, it goes
  /// on from there; else it begins again, which gives the same. Throws what EditSnake throws, and Error 64 for more
  /// than 2,000 steps.
  Now snake(const std::string& token, const OpenCase& one, const segmentation::SnakeEdit& edit, int steps);
  /// What the only edit of the list, which is no patch, would make of the anatomy's shape, as it is drawn. Only what
  /// lies about it is computed. Result and warnings are those of apply_edits(). Throws Error 64 where it lies beyond
  /// the scan.
  Outcome<std::monostate, segmentation::EditsResult> preview(const std::string& token, const OpenCase& one,
                                                             const std::string& anatomy,
                                                             const segmentation::EditList& edit);
  /// To be drawn; null where nothing of that case is watched.
  std::shared_ptr<const DrawnField> field(const std::string& token) const;
  /// Gives the memory back.
  void forget();

 private:
  void show(const std::string& token, DrawnField drawn);

  mutable std::mutex shown_mutex_;  ///< of the two members below
  std::string token_;
  std::shared_ptr<const DrawnField> shown_;
  std::mutex work_mutex_;  ///< of the rest
  std::shared_ptr<const grid::HuVolume> scan_;
  std::string snake_of_;  ///< the edit, as text, without its steps
  std::optional<segmentation::EditSnake> snake_;
};

}  // namespace trephine::desk
