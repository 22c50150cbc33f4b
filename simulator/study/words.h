// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "study/study.h"

namespace trephine::study {

/// How a study's results are worded, on a terminal and on a page.
std::string figure(double v);  ///< four digits
std::string figures(const Interval& i);
std::string p_text(double p);
/// "Welch: -2.1 (30.2 degrees), p = 0.0412, ...", or why it was not tested.
std::string sentence(const NamedTest& test);
std::string effect_name(const std::string& test);
/// "A to B, 12 pairs, mean -5.2 %".
std::string pair_title(const Comparison& c, const PairTests& p);
/// The table of acceptable results, as Table XVI of the dissertation.
std::vector<std::string> acceptable_head();
std::vector<std::string> acceptable_cells(const AcceptableRow& row);
/// "before to after, 12 pairs: 5 became acceptable, 1 no more, 6 as before; McNemar: p = 0.2188".
std::string sentence(const AcceptableChange& change);

}  // namespace trephine::study
