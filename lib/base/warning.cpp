// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/warning.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include "base/error.h"

namespace trephine {

std::string to_text(const Warning& warning) {
  if (warning.values.empty()) return warning.form;
  fmt::dynamic_format_arg_store<fmt::format_context> values;
  for (const auto& [name, value] : warning.values) {
    if (std::holds_alternative<std::vector<double>>(value))
      values.push_back(fmt::arg(name.c_str(), to_text(value)));
    else
      std::visit(
          [&, &name = name](const auto& v) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(v)>, std::vector<double>>)
              values.push_back(fmt::arg(name.c_str(), v));
          },
          value);
  }
  try {
    return fmt::vformat(warning.form, values);
  } catch (const fmt::format_error& e) {
    throw Error(ExitCode::internal, "", warning.id, std::string("its words do not fit its values: ") + e.what());
  }
}

}  // namespace trephine
