// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <ctime>
#include <mutex>

#include "base/joined.h"
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

// How many bytes of UTF-8 make the character that begins there; 0 where none does.
std::size_t length_of_character(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(at);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xC0) != 0x80) return 0;
  const unsigned second = byte(at + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool none = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);  // surrogates, too large
  return overlong || none ? 0 : length;
}

// The text is printable already: JSON asks beside that for escaped quotes and backslashes, and for sound UTF-8.
std::string in_json(const std::string& text) {
  std::string out;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length + (length == 0)) {
    length = length_of_character(text, at);
    out += length == 0 ? "?" : text.substr(at, length);
  }
  return in_quotes(out);
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
                      in_json(printable(form.program)) + ",\"text\":" + in_json(printable(text)) + "}");
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

bool log_tells(LogLevel level) {
  const std::lock_guard<std::mutex> lock(log_mutex());
  return level <= log_form().level;
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
