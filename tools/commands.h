// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine::tools {

/// Commands that do more than run a stage, one in each file of this folder. All other commands come from the
/// declarations of the stages (stage_command.h).
cli::Command phantom_command();
cli::Command import_command();
cli::Command anatomy_command();
cli::Command measure_command();
cli::Command run_command();
cli::Command trade_command();
cli::Command export_command();
cli::Command convert_command();
cli::Command page_command();
cli::Command diff_command();
cli::Command correction_command();
cli::Command preview_command();
cli::Command rubric_command();
cli::Command questionnaire_command();
cli::Command boolean_command();
cli::Command voxelize_command();
cli::Command repair_command();
cli::Command register_command();
cli::Command library_build_command();
cli::Command library_list_command();
cli::Command library_show_command();
cli::Command library_verify_command();
cli::Command library_gc_command();
cli::Command library_job_command();
cli::Command library_approve_command();
cli::Command library_plan_command();
cli::Command library_one_command();
cli::Command library_status_command();
cli::Command library_cancel_command();
cli::Command library_timeline_command();
cli::Command library_task_command();
cli::Command library_finish_command();
cli::Command desk_command();

}  // namespace trephine::tools
