// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_parts.h"

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "grid/bounded_read.h"

namespace trephine::tools {

std::vector<std::string> items_of(const cli::ParsedCommand& parsed, const std::string& argument) {
  std::vector<std::string> items;
  for (const std::string& text : parsed.all(argument)) {
    std::size_t from = 0;
    for (std::size_t comma; (comma = text.find(',', from)) != std::string::npos; from = comma + 1)
      items.push_back(text.substr(from, comma - from));
    items.push_back(text.substr(from));
  }
  return items;
}

void export_usage(const std::string& field, const std::string& what) { throw Error(ExitCode::usage, "", field, what); }

void unknown_name(const std::string& field, const std::string& name, const std::vector<std::string>& known) {
  const std::string near = nearest_name(name, known);
  export_usage(field, name + (near.empty() ? ": must be one of " + joined(known) : ": did you mean " + near + "?"));
}

void check_export_name(const std::string& field, const std::string& name) {
  bool good = !name.empty() && name.size() <= 64 && name[0] != '.';
  for (const char c : name)
    good = good && ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                    c == '-' || c == '.');
  if (!good) export_usage(field, name + ": must be 1 to 64 letters, digits, _, - or .");
}

namespace {

// The recipes' colours, and some more that can be told apart.
std::array<double, 3> label_colour(const cases::CaseManifest& manifest, const std::string& name, std::size_t number) {
  if (const cases::CaseAnatomy* a = manifest.find_anatomy(name)) return a->colour_rgb;
  if (name == "skin") return {0.87, 0.68, 0.56};
  if (name == "skull" || name == "bone") return {0.93, 0.89, 0.78};
  if (name == "brain") return {0.85, 0.62, 0.62};
  if (name == "ventricles") return {0.25, 0.5, 0.9};
  constexpr std::array<double, 3> others[] = {{0.9, 0.3, 0.2}, {0.2, 0.7, 0.3}, {0.95, 0.75, 0.1},
                                              {0.6, 0.3, 0.8}, {0.1, 0.7, 0.7}, {0.9, 0.5, 0.7}};
  return others[number % 6];
}

}  // namespace

Outcome<meshio::LabelMap, meshio::LabelMapResult> label_map_of(const cli::ParsedCommand& parsed,
                                                               const cases::CaseManifest& manifest,
                                                               const Progress& progress) {
  std::list<grid::Field> fields;
  std::vector<meshio::LabelledField> shapes;
  for (const std::string& item : items_of(parsed, "labels")) {
    const auto equals = item.find('=');
    if (equals == std::string::npos) export_usage("--labels", item + ": must be NAME=FIELD.nrrd");
    const std::string name = item.substr(0, equals);
    check_export_name("--labels", name);
    for (const meshio::LabelledField& s : shapes)
      if (s.name == name) export_usage("--labels", name + ": is there twice");
    fields.push_back(grid::read_foreign_field(item.substr(equals + 1)));
    shapes.push_back({&fields.back(), name, label_colour(manifest, name, shapes.size())});
    progress.check();
  }
  return meshio::make_label_map(shapes, progress);
}

}  // namespace trephine::tools
