// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/result.h"

#include "base/error.h"

namespace trephine {
namespace {

// -0 becomes 0, so that equal values give equal bytes, made now or read from a cache.
ParameterValue plain(ParameterValue value) {
  if (auto* number = std::get_if<double>(&value)) *number += 0.0;
  if (auto* numbers = std::get_if<std::vector<double>>(&value))
    for (double& v : *numbers) v += 0.0;
  return value;
}

void add_figures(const ParameterSet& set, void* object, const std::string& prefix, Named<ParameterValue>& out) {
  for (const Parameter& p : set.parameters) {
    if (is_absent(p, set, object)) continue;
    if (p.is_value()) {
      out.emplace_back(prefix + p.name, plain(p.get(object)));
      continue;
    }
    const std::string before = p.bare_items ? prefix : prefix + p.name + ".";
    std::size_t number = 0;
    for (const ParameterItem& item : p.items(object)) {
      ++number;
      const std::string name = p.kind == ParameterKind::list ? std::to_string(number) : item.name;
      const ParameterSet& of_item = p.set_of(item);
      if (const Parameter* only = of_item.only_value())
        out.emplace_back(before + p.item_beginning + name + p.item_ending, plain(only->get(item.object)));
      else
        add_figures(of_item, item.object, name.empty() ? before : before + name + p.item_separator, out);
    }
  }
}

}  // namespace

Named<ParameterValue> figures_of(const ParameterSet& set, const void* result) {
  Named<ParameterValue> out;
  add_figures(set, const_cast<void*>(result), "",
              out);  // the items of a list are listed by a function that could write
  return out;
}

Report printed(Named<ParameterValue> figures, const Warnings& warnings) {
  Report report;
  report.figures = std::move(figures);
  for (const Warning& w : warnings) report.warnings.push_back(to_text(w));
  return report;
}

namespace detail {
void refuse_result(const ParameterSet* is, const ParameterSet& wanted) {
  const auto first = [](const ParameterSet* set) {
    return !set || set->parameters.empty() ? std::string("nothing") : set->parameters[0].name;
  };
  throw Error(ExitCode::internal, "", "result", "of " + first(is) + " is read as one of " + first(&wanted));
}
}  // namespace detail

}  // namespace trephine
