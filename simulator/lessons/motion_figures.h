// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "haptics/frame.h"
#include "texts/language.h"

namespace trephine::lessons {

/// How a hand moved, as figures beside a score; none of them scores. They are of the device's tip, in means of 10 ms,
/// and no way is counted over a change of the tool, a lifted tool or missing frames. A movement is a stretch of at
/// least 0.2 s in which the tip is faster than 5 mm/s.
///
/// path_mm: the whole way. tissue_path_mm: of the shown tip, within a shape. economy_ratio: straight distances over the
/// ways of all movements. smoothness_sparc: spectral arc length of the movements' speeds [Balasubramanian2015],
/// weighted by their durations; 0 is the smoothest that can be, tremor and stops make it smaller. idle_s: not faster
/// than 5 mm/s and without contact. tremor_um: root mean square of the tip's place between 8 and 12 Hz, in windows of a
/// second. force_integral_n_s and tissue_force_integral_n_s: of the force's size over time. contact_force_n: its mean
/// in contact. A figure that has nothing to be of is not there.
std::vector<std::pair<std::string, double>> motion_figures(const std::vector<haptics::ServoFrame>& frames);

/// The spectral arc length of a speed at `rate_hz`, with the paper's parameters: up to 10 Hz, amplitudes from 0.05 of
/// the largest on, four more powers of two of zeros. Needs two values, one of them above 0.
double spectral_arc_length(const std::vector<double>& speed, double rate_hz);

/// Between which values an expert's figure lies: the 10th and 90th percentile of at least ten recordings, of fewer the
/// least and the most.
struct ExpertBand {
  std::string name;
  std::size_t count = 0;
  double low = 0, high = 0;
};
std::vector<ExpertBand> expert_bands(const std::vector<std::vector<std::pair<std::string, double>>>& experts);

/// What a hand is told that lies outside of the band by more than a twentieth of its edge, a sentence for each figure:
/// "You moved 2140 mm; experts moved 900 to 1400 mm. Plan the way before you move."
std::vector<std::string> motion_advice(const std::vector<std::pair<std::string, double>>& figures,
                                       const std::vector<ExpertBand>& bands,
                                       texts::Language language = texts::Language::english);

}  // namespace trephine::lessons
