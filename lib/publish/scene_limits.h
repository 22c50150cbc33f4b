// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"
#include "publish/case_table.h"

namespace trephine::publish {

/// Throws Error 80 with remedies where a finished surface has more triangles than the scene allows, or deviates by more
/// from the unreduced one.
void hold_against_limits(const config::SceneAnatomy& limit, const AnatomyResult& result);

/// What the scene asks of single nodes, so that a case is refused before the rest is made: of a decimated surface that
/// it has no more triangles than the scene allows, and of landmarks that they are found as surely as it needs them.
/// `config` must outlive the result.
pipeline::Asked asked_of(const config::CaseConfig& config, const pipeline::Graph& graph);

/// Logs a warning where a surface deviates by more than a bound that a person gave to decimation alone, with the
/// setting of the scene that bounds decimation and smoothing together.
void tell_wider_than_asked(const config::CaseConfig& config, const config::RecipeAnatomy& recipe,
                           const config::SceneAnatomy& limit, double deviation_max_mm);

/// The skin of a head shows the face, and so does a CT of it. Throws Error 81 where the case would publish one and the
/// scene does not say that it may, and why.
void require_face_policy(const config::CaseConfig& config);

}  // namespace trephine::publish
