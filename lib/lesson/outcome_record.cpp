// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/outcome_record.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::lesson {

const char* to_text(Sighting s) {
  return s == Sighting::found ? "found" : s == Sighting::doubtful ? "doubtful" : "none";
}

std::string to_json(const OutcomeRecord& record) {
  return json::declared_json(AnyParams::make<OutcomeRecord>(record)) + "\n";
}

OutcomeRecord parse_outcome(std::string_view text) {
  OutcomeRecord record;
  json::JsonRules rules;
  rules.by_program = true;
  rules.max_bytes = 4 << 20;
  json::read_declared_json(text, parameters_of<OutcomeRecord>(), &record, rules);
  return record;
}

OutcomeRecord read_outcome(const std::filesystem::path& file, std::string* sha256) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 4 << 20);
    const std::string_view text(bytes.data(), bytes.size());
    if (sha256) *sha256 = sha256_of_bytes(text);
    return parse_outcome(text);
  });
}

}  // namespace trephine::lesson
