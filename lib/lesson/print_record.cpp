// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/print_record.h"

#include "base/error.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::lesson {

std::string to_json(const PrintRecord& record) {
  return json::declared_json(AnyParams::make<PrintRecord>(record)) + "\n";
}

PrintRecord parse_print(std::string_view text) {
  PrintRecord record;
  json::JsonRules rules;
  rules.by_program = true;
  json::read_declared_json(text, parameters_of<PrintRecord>(), &record, rules);
  return record;
}

PrintRecord read_print(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 20);
    return parse_print({bytes.data(), bytes.size()});
  });
}

}  // namespace trephine::lesson
