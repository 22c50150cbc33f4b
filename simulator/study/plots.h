// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "study/study.h"
#include "texts/phrase.h"

namespace trephine::study {

/// Equal bins from `begin`: their count and width.
struct Bins {
  double begin = 0, width = 1;
  int count = 1;
};
/// By Freedman and Diaconis (Sturges where half of the values are equal), in round widths; whole numbers in a range of
/// at most 30 get a bin each. `count` above 0: as many, over the range.
Bins bins_for(const std::vector<double>& values, int count);

/// A picture of a study: the name of its file without the ending, what it shows, and its script (base/gnuplot.h).
struct StudyPlot {
  std::string measure, file, title, script;
};
/// Box plots and histograms of each comparison, as figures 46 to 48 of the dissertation, and learning curves. The data
/// of scripts are in full, so that the picture changes with them. Titles and labels are said by `words`: "{} by {}",
/// "median", "participants", the names of measures and, of the phases alone, those of samples.
using PlotWords = std::function<std::string(const texts::Phrase&)>;
std::vector<StudyPlot> plots_of(const Study& study, const PlotWords& words = &texts::Phrase::english);
constexpr int plot_width = 640, plot_height = 400;

/// The study as one HTML page, with its pictures (SVG, by file of the plot, where they could be drawn) in it. It needs
/// no other file and holds no script.
std::string study_page(const Study& study, const std::vector<std::pair<StudyPlot, std::string>>& pictures);

}  // namespace trephine::study
