// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <ctime>
#include <mutex>

#include "base/text.h"

namespace trephine {
namespace {

std::mutex& log_mutex() {
  static std::mutex mutex;
  return mutex;
}

LogSink& log_sink() {
  static LogSink sink;
  return sink;
}

}  // namespace

namespace {

LogForm& log_form() {
  static LogForm form;
  return form;
}

const char* name_of(LogLevel level) {
  switch (level) {
    case LogLevel::error:
      return "error";
    case LogLevel::warning:
      return "warning";
    default:
      return "info";
  }
}

// The text is printable already: what JSON asks for beside that is the quotes and backslashes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string time_text() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  tm parts{};
  gmtime_r(&now.tv_sec, &parts);
  char text[128];
  std::snprintf(text, sizeof text, "%04d-%02d-%02dT%02d:%02d:%02d.%03ldZ", parts.tm_year + 1900, parts.tm_mon + 1,
                parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec, now.tv_nsec / 1'000'000);
  return text;
}

void write_line(std::string line) {
  line += '\n';
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t n = ::write(STDERR_FILENO, line.data() + done, line.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // stderr is closed, so there is nobody to report this to
    done += static_cast<std::size_t>(n);
  }
}

void log(LogLevel level, const std::string& text) {
  const std::lock_guard<std::mutex> lock(log_mutex());
  const LogForm& form = log_form();
  if (level > form.level) return;
  if (form.json)
    return write_line("{\"time\":\"" + time_text() + "\",\"level\":\"" + name_of(level) + "\",\"program\":" +
                      quoted(printable(form.program)) + ",\"text\":" + quoted(printable(text)) + "}");
  const std::string line = printable(level == LogLevel::warning ? "warning: " + text : text);
  if (log_sink()) return log_sink()(line);
  write_line(line);
}

}  // namespace

void log_line(const std::string& text) { log(LogLevel::info, text); }
void log_warning(const std::string& text) { log(LogLevel::warning, text); }
void log_error(const std::string& text) { log(LogLevel::error, text); }

void set_log_form(const LogForm& form) {
  const std::lock_guard<std::mutex> lock(log_mutex());
  log_form() = form;
}

bool log_is_json() {
  const std::lock_guard<std::mutex> lock(log_mutex());
  return log_form().json;
}

LogSink set_log_sink(LogSink sink) {
  const std::lock_guard<std::mutex> lock(log_mutex());
  std::swap(sink, log_sink());
  return sink;
}

}  // namespace trephine
