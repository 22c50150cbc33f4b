// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "lessons/score.h"
#include "lessons/spine/needle_watch.h"

namespace trephine::lessons {

/// A row of that name and title, with its four limits as limits of that unit.
ScoreRow four_limits_row(const char* name, const char* title, const lesson::FourLimits& limits,
                         const std::string& unit);

/// How long X-rays were on; 1 where no picture was taken, where a tool went into bone without one before, and where
/// `nowhere` says why no tool lies where it should: few pictures are no merit of who placed nothing.
ScoreRow exposure_row(const SpineNeedleFacts& facts, const lesson::FourLimits& limits, const texts::Phrase& nowhere);

/// How often a tool entered bone, or the skin without meeting bone.
int entries_count(const SpineNeedleFacts& facts);
/// The same as a row, lowered by how fast it went in. `nowhere`: why none lies where it should, and the row scores 1;
/// empty: one does.
ScoreRow bone_passes_row(const SpineNeedleFacts& facts, const lesson::FourLimits& limits, const char* title,
                         const std::optional<lesson::FourLimits>& mm_per_s, const texts::Phrase& nowhere);

/// How long it took, without pauses. `unreached`: why the goal was not reached, and the row scores 1; empty: it was.
ScoreRow spine_time_row(const SpineNeedleFacts& facts, const lesson::FourLimits& limits,
                        const texts::Phrase& unreached);

}  // namespace trephine::lessons
