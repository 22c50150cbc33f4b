// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/mrml.h"

#include "base/html_text.h"

namespace trephine::slicer {
namespace {

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + html_text(value) + "\"";
}

}  // namespace

void Mrml::element(const std::string& tag, const std::string& id, const std::string& name, const std::string& singleton,
                   bool hidden, const Attributes& attributes) {
  elements_ += " <" + tag + attribute("id", id) + attribute("name", name) +
               attribute("hideFromEditors", hidden ? "true" : "false") + attribute("selectable", "true") +
               attribute("selected", "false");
  if (!singleton.empty()) elements_ += attribute("singletonTag", singleton);
  for (const auto& [key, value] : attributes) elements_ += attribute(key, value);
  elements_ += "></" + tag + ">\n";
}

std::string Mrml::add(const std::string& tag, const std::string& node_class, const std::string& name,
                      const Attributes& attributes) {
  std::string id = node_class + std::to_string(++numbers_[node_class]);
  element(tag, id, name, "", tag != "Camera", attributes);
  return id;
}

std::string Mrml::add_singleton(const std::string& tag, const std::string& node_class, const std::string& singleton,
                                const std::string& name, const Attributes& attributes) {
  std::string id = node_class + singleton;
  element(tag, id, name, singleton, tag != "View" && tag != "Slice", attributes);
  return id;
}

std::string Mrml::add_data(const std::string& tag, const std::string& node_class, const std::string& name,
                           const std::string& display, const std::string& storage, const Attributes& attributes,
                           const std::string& more) {
  std::string id = node_class + std::to_string(++numbers_[node_class]);
  Attributes all{{"displayNodeRef", display},
                 {"storageNodeRef", storage},
                 {"references", "display:" + display + ";storage:" + storage + ";" + more}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  element(tag, id, name, "", false, all);
  return id;
}

void Mrml::add_units(const std::string& volume) {
  const std::string length = add_singleton("Unit", "vtkMRMLUnitNode", "ApplicationLength", "ApplicationLength",
                                           {{"Quantity", "length"}, {"Suffix", "mm"}, {"Precision", "3"}});
  add_singleton("Selection", "vtkMRMLSelectionNode", "Singleton", "Selection",
                {{"lengthUnitNodeRef", length},
                 {"references", "unit/length:" + length + ";"},
                 {"activeVolumeID", volume.empty() ? "NULL" : volume}});
}

std::string Mrml::text(const std::string& program) const {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- " + html_text(program) +
         " -->\n<MRML version=\"Slicer5\" userTags=\"\">\n" + elements_ + "</MRML>\n";
}

}  // namespace trephine::slicer
