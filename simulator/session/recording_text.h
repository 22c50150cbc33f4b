// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/write_file.h"
#include "haptics/recording.h"

namespace trephine::session {

/// How a recording is written for other programs.
struct RecordingTextParams {
  int every_count = 1;
  template <class V>
  static void describe(V& v) {
    v.integer(&RecordingTextParams::every_count, "every_count", Range{1, 1000000},
              "Take one of so many frames; a frame then has the events, faults and commands of those before it that "
              "were passed over, and their largest lateness.");
  }
};

/// The columns of a recording as text, each with one line of help, in their order. Names end in the unit; positions are
/// LPS.
std::vector<std::pair<std::string, std::string>> recording_columns(const haptics::RecordingHeader& header);

/// CSV with a line of names: a frame a line, each number in the shortest form that reads back to the same value. What
/// is not finite is empty. Events and faults are names with + between them. The caller commits.
void write_recording_csv(const haptics::Recording& recording, const RecordingTextParams& params, FileWriter& out);

/// Plain JSON: the header, the columns with their help, and the frames as arrays in the order of the columns, one a
/// line. What is not finite is null.
void write_recording_json(const haptics::Recording& recording, const RecordingTextParams& params, FileWriter& out);

/// Force, position, the tool in hand and events over time as a script for base/gnuplot.h. Of many frames each piece of
/// time shows its least and largest value, so no peak is lost.
std::string recording_plot(const haptics::Recording& recording);
constexpr int recording_plot_width = 1000, recording_plot_height = 760;

}  // namespace trephine::session
