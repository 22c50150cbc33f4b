// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/attempts.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::lessons {
namespace {

constexpr std::size_t participant_at = 0, module_at = 1, attempt_at = 2, recording_at = 4, rubric_at = 5;
// 1 to 5; empty where there is no such row, or it is not judged.
std::string points_of(const LessonScore& score, const std::string& name) {
  const ScoreRow* row = score.row(name);
  return row && row->score ? std::to_string(*row->score) : std::string();
}

std::string text_of(const decltype(LessonFigure::value)& value) {
  if (std::holds_alternative<std::monostate>(value)) return "";
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "1" : "0";
  if (const int* count = std::get_if<int>(&value)) return std::to_string(*count);
  return to_text(std::get<double>(value));
}

std::string cell_of(const LessonScore& score, const LessonColumn& column) {
  if (column.row.empty()) return text_of(score.figure(column.name).value);
  if (const ScoreRow* row = score.row(column.row))
    for (const auto& [name, value] : row->measured)
      if (name == column.name) return to_text(value);
  return "";
}

std::string head_line(const LessonType& module) {
  return joined(attempt_columns(module), ",", [](const auto& column) { return column.first; });
}

// A log of before columns were added, with these left empty; as it is, where it has others.
std::string with_new_columns(const std::string& old, const std::string& columns) {
  const std::vector<std::string> lines = split_at(old, '\n'), now = split_at(columns, ',');
  const std::vector<std::string> then = split_at(lines.front(), ',');
  if (lines.front() == columns || then.size() < 9) return old;
  std::vector<std::size_t> places;  // of each old column among the new ones
  for (const std::string& name : then) {
    const auto at = std::find(now.begin(), now.end(), name);
    if (at == now.end()) return old;
    places.push_back(std::size_t(at - now.begin()));
  }
  std::string out = columns + "\n";
  for (std::size_t n = 1; n + 1 < lines.size(); ++n) {
    const std::vector<std::string> cells = split_at(lines[n], ',');
    if (cells.size() != then.size()) return old;
    std::vector<std::string> moved(now.size());
    for (std::size_t c = 0; c < cells.size(); ++c) moved[places[c]] = cells[c];
    for (std::size_t c = 0; c < moved.size(); ++c) out += (c > 0 ? "," : "") + moved[c];
    out += "\n";
  }
  return out;
}

// Holds the log for this process as long as it lives.
class LogLock {
 public:
  explicit LogLock(const std::filesystem::path& log) {
    std::filesystem::path file = log;
    file += ".lock";
    fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (fd_ < 0) throw Error(ExitCode::cannot_create, file.string(), "", "cannot be made");
    while (::flock(fd_, LOCK_EX) != 0)
      if (errno != EINTR) {
        ::close(fd_);
        throw Error(ExitCode::io, file.string(), "", std::string("cannot be locked: ") + std::strerror(errno));
      }
  }
  ~LogLock() { ::close(fd_); }
  LogLock(const LogLock&) = delete;
  LogLock& operator=(const LogLock&) = delete;

 private:
  int fd_;
};

}  // namespace

std::vector<std::pair<std::string, std::string>> attempt_columns(const LessonType& module) {
  std::vector<std::pair<std::string, std::string>> c = {
      {"participant", "anonymous token"},
      {"module", "the lesson"},
      {"attempt", "counts the participant's motions of the module in this log, from 1"},
      {"case", "the case's token"},
      {"recording_sha256", "of the recording's file"},
      {"rubric_sha256", "of what the rubric says"},
      {"end", "finished, not finished, device lost"},
      {"points", "sum of the rows that were judged"},
      {"most_points", "what that sum could have been"}};
  for (const std::string& row : module.rows) c.emplace_back(row + "_score", "1 to 5; empty: not judged");
  for (const LessonColumn& column : module.columns) c.emplace_back(column.name, column.help);
  c.emplace_back("motion_sha256", "of what the hand did, by which attempts are counted");
  c.emplace_back("checked", "replayed, or trusted: the recording's answers as they stand in it");
  c.emplace_back("repeats", "the participant and attempt whose motion it is, where it was in the log");
  c.emplace_back("task", "what was asked for; empty: nothing");
  c.emplace_back("outcome", "completed, not completed, or failed by a critical error");
  c.emplace_back("critical_errors", "those that happened, by name, with + between them");
  c.emplace_back("decisions_score", "1 to 5, of what was asked; empty: nothing was");
  c.emplace_back("seal", "sealed, not sealed (written into a pipe), or broken seal, where the recording was trusted");
  c.emplace_back("signature", "signed by the teacher whose key was given, not signed; empty: no key was given");
  return c;
}

std::string attempt_line(const ReportHead& head, const LessonFacts& facts, const LessonScore& score, int attempt,
                         const std::string& repeats) {
  const LessonType& module = lesson_type(head.module);
  const ScoreSum sum = sum_of(score);
  std::string line = head.participant + "," + head.module + "," + std::to_string(attempt) + "," + head.case_token +
                     "," + head.recording_sha256 + "," + head.rubric_sha256 + "," + name_of(facts.end) + "," +
                     std::to_string(sum.points) + "," + std::to_string(sum.most);
  for (const std::string& name : module.rows) line += "," + points_of(score, name);
  for (const LessonColumn& column : module.columns) line += "," + cell_of(score, column);
  const std::string critical = joined(score.critical, "+", [](const CriticalError& e) { return e.rule.error; });
  line += "," + head.motion_sha256 + "," + head.checked() + "," + repeats;
  line += "," + facts.task + "," + name_of(score.outcome()) + "," + critical;
  line += "," + points_of(score, "decisions") + "," + haptics::name_of(head.seal) + "," + name_of(head.signature);
  return line;
}

int log_attempt(const std::filesystem::path& file, const ReportHead& head, const LessonFacts& facts,
                const LessonScore& score, std::string* repeats) {
  const LogLock lock(file);
  const std::string columns = head_line(lesson_type(head.module));
  const std::vector<std::string> names = split_at(columns, ',');
  const auto place = [&](const char* name) {
    return std::size_t(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::size_t motion_at = place("motion_sha256"), checked_at = place("checked"),
                    signature_at = place("signature");
  std::string text = columns + "\n", others;
  std::set<std::string> attempts;
  int known = 0;  // the number of this motion's attempt
  bool there = false;
  if (std::filesystem::exists(file)) {
    const std::vector<char> bytes = read_file(file, 1 << 28);
    const std::string old = with_new_columns({bytes.begin(), bytes.end()}, columns);
    const std::vector<std::string> lines = split_at(old, '\n');
    if (lines.front() != columns || old.back() != '\n')
      throw Error(ExitCode::bad_input, file.string(), "columns",
                  "are not those of a log of attempts of this lesson and version");
    for (std::size_t n = 1; n + 1 < lines.size(); ++n) {
      const std::vector<std::string> cells = split_at(lines[n], ',');
      if (cells.size() != names.size())
        throw Error(ExitCode::bad_input, file.string(), "line " + std::to_string(n + 1), "has another count of cells");
      // A line of before motions were noted is known by its recording.
      const bool by_motion = !cells[motion_at].empty() && !head.motion_sha256.empty();
      const bool same_file = cells[recording_at] == head.recording_sha256;
      const bool same = by_motion ? cells[motion_at] == head.motion_sha256 : same_file;
      if (same && !same_file && others.empty()) others = cells[participant_at] + " " + cells[attempt_at];
      if (cells[participant_at] != head.participant || cells[module_at] != head.module) continue;
      attempts.insert(cells[attempt_at]);
      if (!same) continue;
      if (known == 0) known = int(parse_integer(cells[attempt_at]).value_or(0));
      // Scored by another rubric, replayed after it was trusted, or signed since, it is the same attempt.
      there = there || (cells[rubric_at] == head.rubric_sha256 && (!by_motion || cells[checked_at] == head.checked()) &&
                        (head.signature == Signature::not_asked || cells[signature_at] == name_of(head.signature)));
    }
    text = old;
  }
  if (repeats && !others.empty()) *repeats = std::string(others).insert(others.find(' '), ", attempt");
  const int attempt = known > 0 ? known : int(attempts.size()) + 1;
  if (!there) write_file(file, text + attempt_line(head, facts, score, attempt, others) + "\n");
  return attempt;
}

}  // namespace trephine::lessons
