// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace trephine {

/// One line on stderr, whole even from several threads: what the user should know of a run that goes on. Control characters
/// are replaced. Never a patient's name, ID or UID.
void log_line(const std::string& text);
/// log_line("warning: ...").
void log_warning(const std::string& text);

}  // namespace trephine
