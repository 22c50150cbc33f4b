// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lesson/rubric.h"

namespace trephine::lessons {

/// The rubrics of all lessons, by name: every simulator/lessons/NAME/NAME_rubric.cpp defines `RubricType
/// NAME_rubric()`, and CMake finds it. They are a library of their own, which sees lib/lesson and lib/base alone, so
/// that `trephine` compiles rubrics without anything else of the simulator.
const std::vector<lesson::RubricType>& rubric_types();

}  // namespace trephine::lessons
