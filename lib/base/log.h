// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>

namespace trephine {

/// One line on stderr, whole even from several threads: what the user should know of a run that goes on. Control
/// characters are replaced. Never a patient's name, ID or UID.
void log_line(const std::string& text);
/// log_line("warning: ...").
void log_warning(const std::string& text);

/// Sends the lines (without their newline) elsewhere, one call at a time; null sends them to stderr again. For displays
/// that own the terminal's last line. Returns the sink before.
using LogSink = std::function<void(const std::string& line)>;
LogSink set_log_sink(LogSink sink);

}  // namespace trephine
