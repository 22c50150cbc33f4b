// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>

namespace trephine {

/// Writes one line to stderr that the user should read during a run. Lines of several threads never mix. Control
/// characters are replaced. The text must never hold a patient's name, ID or UID.
void log_line(const std::string& text);
/// The same as log_line("warning: " + text).
void log_warning(const std::string& text);

/// Sends the lines (without their newline) to `sink`, one call at a time; null sends them to stderr again. It is for
/// displays that own the terminal's last line. Returns the previous sink.
using LogSink = std::function<void(const std::string& line)>;
LogSink set_log_sink(LogSink sink);

}  // namespace trephine
