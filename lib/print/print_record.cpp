// SPDX-License-Identifier: GPL-3.0-or-later
#include "print/print_record.h"

#include "base/error.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::print {

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

itk::LinearMap map_of(const std::array<double, 12>& rows) {
  itk::LinearMap map;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t k = 0; k < 3; ++k) map.matrix.column[k][int(a)] = rows[4 * a + k];
    map.offset_mm[int(a)] = rows[4 * a + 3];
  }
  return map;
}

std::array<double, 12> rows_of(const itk::LinearMap& map) {
  std::array<double, 12> rows{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t k = 0; k < 3; ++k) rows[4 * a + k] = map.matrix.column[k][int(a)];
    rows[4 * a + 3] = map.offset_mm[int(a)];
  }
  return rows;
}

}  // namespace trephine::print
