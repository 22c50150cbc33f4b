// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "json/job_status.h"

namespace trephine::cli {

/// Whether another program asked for this one's status (json::job_status_variable). The first call takes the variable
/// out of the environment, so that programs that this one starts do not write there; call it before there are threads.
bool has_job_status();
/// Writes it where it was asked for.
void write_job_status(const json::JobStatus& status);

}  // namespace trephine::cli
