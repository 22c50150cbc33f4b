// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "cases/load_case.h"
#include "lessons/score_report.h"

namespace trephine::lessons {

/// The report as one HTML file that a person reads: scores with figures, limits and moments, forces over time, and the
/// module's pictures, such as the tools' ways over the case's CT. It needs no other
/// file, holds no script, and its content security policy allows none. `loaded` should hold the CT; without one the
/// ways are drawn on nothing, and the page says so. The same inputs give the same bytes.
std::string report_page(const ReportHead& head, const LessonFacts& facts, const LessonScore& score,
                        const haptics::Recording& recording, const cases::LoadedCase& loaded);

}  // namespace trephine::lessons
