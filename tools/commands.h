// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cli/command.h"

namespace trephine {

/// The program's commands, one a file in this folder.
Command phantom_command();
Command import_command();
Command resample_command();
Command deface_command();
Command segment_command();
Command labels_command();
Command presegment_command();
Command snake_command();
Command landmarks_command();
Command canal_command();
Command clavicle_command();
Command vein_command();
Command contour_command();
Command decimate_command();
Command smooth_command();
Command normals_command();
Command repair_command();
Command simplify_command();
Command anatomy_command();
Command remesh_command();
Command measure_command();
Command run_command();
Command trade_command();
Command export_command();
Command boolean_command();
Command burrhole_command();
Command voxelize_command();
Command library_build_command();
Command library_list_command();
Command library_show_command();
Command library_verify_command();
Command library_gc_command();
Command library_job_command();

}  // namespace trephine
