// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "scenes.h"
#include "stages/stage.h"

namespace trephine::extremes {

/// A stage with an input that it can work on: what its parameters are swept around.
struct Subject {
  const stages::StageType* stage = nullptr;
  std::string label;  ///< "segment", or "segment, method brain"
  Body body = Body::balls;
  std::vector<std::string> ports;  ///< optional ones that are filled
  std::vector<std::pair<std::string, std::string>> base;
};

/// Every stage, and once for each method that it has; known stages with an input that suits them, any other with a
/// sphere in a sphere.
std::vector<Subject> subjects_of(const stages::StageType& stage);

/// The items of a parameter's text, as the command line and configurations give them.
std::vector<std::string> items_of(const Parameter& parameter, const std::string& text);

/// Sets one; throws Error 64 with the parser's word.
void set(AnyParams& params, const std::string& name, const std::string& text);

AnyParams params_of(const Subject& subject);
/// False where the scene has no surface for it.
bool fill(stages::StageInputs& inputs, const Subject& subject, const Scene& scene);
/// The usual scene's.
stages::StageInputs inputs_of(const Subject& subject);
/// These take long: only of the long suite.
bool is_slow(const Subject& subject, const std::string& parameter, const std::string& text);

}  // namespace trephine::extremes
