// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine {

/// Commands that do more than run a stage, one in each file of this folder. All other commands come from the
/// declarations of the stages (stage_command.h).
Command phantom_command();
Command import_command();
Command anatomy_command();
Command measure_command();
Command run_command();
Command trade_command();
Command export_command();
Command convert_command();
Command page_command();
Command diff_command();
Command correction_command();
Command preview_command();
Command rubric_command();
Command boolean_command();
Command voxelize_command();
Command repair_command();
Command register_command();
Command library_build_command();
Command library_list_command();
Command library_show_command();
Command library_verify_command();
Command library_gc_command();
Command library_job_command();
Command library_approve_command();

}  // namespace trephine
