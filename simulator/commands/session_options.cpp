// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/session_options.h"

#include <algorithm>

#include "cli/argument.h"

namespace trephine {

SessionOptions session_options_of(const ParsedCommand& parsed) {
  SessionOptions o;
  o.case_folder = parsed.path("case");
  o.shape = parsed.text("shape");
  if (parsed.has("device")) o.device.name = parsed.text("device");
  o.device.params = parsed.groups;
  for (const DeviceType& type : device_types())
    for (const Argument& file : type.files)
      if (parsed.has(file.name)) o.device.files[file.name] = parsed.path(file.name);
  o.workspace = parsed.params<WorkspaceParams>();
  o.servo = parsed.params<ServoParams>();
  o.contact = parsed.params<ContactParams>();
  o.force = parsed.params<ForceParams>();
  o.tool = parsed.params<ToolParams>();
  o.shaft = parsed.params<ShaftParams>();
  o.drilling = parsed.params<DrillingParams>();
  o.law = parsed.params<DrillParams>();
  o.record = parsed.path("record");
  return o;
}

// "a, b, or c": what --device may be, as the kinds say it themselves.
std::string devices_text() {
  const std::vector<DeviceType>& all = device_types();
  std::string text;
  for (const DeviceType& type : all) text += (text.empty() ? "" : &type == &all.back() ? ", or " : ", ") + type.help;
  return text;
}

std::vector<Argument> session_arguments(const std::string& own) {
  Argument folder = argument("case", Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  Argument device =
      argument("device", Argument::Kind::choice, "Who holds the tool; " + own + " where it is not given.");
  std::vector<Argument> all = {folder, device};
  for (const DeviceType& type : device_types()) {
    all[1].choices.push_back(type.name);
    all.insert(all.end(), type.files.begin(), type.files.end());
  }
  if (std::find(all[1].choices.begin(), all[1].choices.end(), own) == all[1].choices.end())
    all[1].choices.push_back(own);
  all.push_back(
      argument("shape", Argument::Kind::text, "The only shape that is felt; without it, all shapes of the case."));
  all.push_back(argument("record", Argument::Kind::out_file, "Write every tick to this file."));
  return all;
}

Argument before_argument() {
  Argument before = argument("before", Argument::Kind::in_file,
                             "A recording that came before on the same patient, in their order; needed where another "
                             "tool was taken after something had been cut.");
  before.repeated = true;
  return before;
}

std::vector<ParameterGroup> session_groups() {
  std::vector<ParameterGroup> all = {ParameterGroup::of<ServoParams>("Servo loop"),
                                     ParameterGroup::of<ContactParams>("Contact"),
                                     ParameterGroup::of<ForceParams>("Force"),
                                     ParameterGroup::of<ToolParams>("Tool"),
                                     ParameterGroup::of<ShaftParams>("Its shaft"),
                                     ParameterGroup::of<DrillingParams>("Drilling"),
                                     ParameterGroup::of<DrillParams>("The law of removal"),
                                     ParameterGroup::of<WorkspaceParams>("The device's workspace")};
  for (const DeviceType& type : device_types()) all.insert(all.end(), type.groups.begin(), type.groups.end());
  return all;
}

}  // namespace trephine
