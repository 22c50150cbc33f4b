// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>

namespace trephine {

/// Writes one line to stderr that the user should read during a run. Lines of several threads never mix. Control
/// characters are replaced. The text must never hold a patient's name, ID or UID.
void log_line(const std::string& text);
/// The same as log_line("warning: " + text), of the level warning.
void log_warning(const std::string& text);
/// A line of the level error: why the program ends.
void log_error(const std::string& text);

enum class LogLevel { error, warning, info };

/// How lines are written from now on. Lines of a level above `level` are left out. With `json` each is one object on a
/// line, {"time":"2026-01-31T12:00:00.123Z","level":"warning","program":"trephine run","text":"..."}, and goes to
/// stderr whatever the sink is.
struct LogForm {
  LogLevel level = LogLevel::info;
  bool json = false;
  std::string program;
};
void set_log_form(const LogForm& form);
bool log_is_json();
/// Whether lines of that level are written.
bool log_tells(LogLevel level);

/// Sends the lines (without their newline) to `sink`, one call at a time; null sends them to stderr again. It is for
/// displays that own the terminal's last line. Returns the previous sink.
using LogSink = std::function<void(const std::string& line)>;
LogSink set_log_sink(LogSink sink);

}  // namespace trephine
