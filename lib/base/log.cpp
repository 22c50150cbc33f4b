// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <unistd.h>

#include <cerrno>
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

void log_line(const std::string& text) {
  std::string line = printable(text);
  const std::lock_guard<std::mutex> lock(log_mutex());
  if (log_sink()) return log_sink()(line);
  line += '\n';
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t n = ::write(STDERR_FILENO, line.data() + done, line.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // stderr is closed, so there is nobody to report this to
    done += static_cast<std::size_t>(n);
  }
}

void log_warning(const std::string& text) { log_line("warning: " + text); }

LogSink set_log_sink(LogSink sink) {
  const std::lock_guard<std::mutex> lock(log_mutex());
  std::swap(sink, log_sink());
  return sink;
}

}  // namespace trephine
