// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trephine::window {

/// A place of the window, in pixels from its upper left corner.
struct Place {
  float x = 0, y = 0, width = 0, height = 0;
  bool overlaps(const Place& o) const {
    return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
  }
};

/// Where the panels are at first, and how large they may be: from 1024 x 600 pixels up none lies over another. What
/// does not fit into its place is scrolled.
struct Layout {
  Place work;      ///< the patient, or the lesson's steps: on the left
  Place status;    ///< on the right
  Place xray;      ///< of a lesson with a C-arm: below the status
  Place scores;    ///< of a review: below the status
  Place shots;     ///< of a review: below the patient
  Place time;      ///< of a recording: along the lower edge
  Place transfer;  ///< the editor of the transfer function, over the lower part of the patient
  Place patient;   ///< what none of them may cover: between the columns, as high as the window
  /// `letter`: height of a letter. What is not shown has no place.
  Layout(float width, float height, float letter, bool has_xray, bool has_scores, bool has_shots, bool has_time);
};

}  // namespace trephine::window
