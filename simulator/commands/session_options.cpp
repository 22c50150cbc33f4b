// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/session_options.h"

#include <algorithm>

#include "base/error.h"
#include "cli/argument.h"

namespace trephine::commands {

session::SessionOptions session_options_of(const cli::ParsedCommand& parsed) {
  session::SessionOptions o;
  o.case_folder = parsed.path("case");
  o.shape = parsed.text("shape");
  if (parsed.has("device")) o.device.name = parsed.text("device");
  o.device.params = parsed.groups;
  for (const device::DeviceType& type : device::device_types())
    for (const cli::Argument& file : type.files)
      if (parsed.has(file.name)) o.device.files[file.name] = parsed.path(file.name);
  o.workspace = parsed.params<device::WorkspaceParams>();
  if (device::is_placed(o.device.name) && !device::is_unmoved(o.workspace))
    throw Error(ExitCode::usage, "", "--device " + o.device.name + ", --workspace-...",
                "do not go together, on the command line or in --settings: the registration says where the tool is");
  o.servo = parsed.params<haptics::ServoParams>();
  o.contact = parsed.params<contact::ContactParams>();
  o.force = parsed.params<haptics::ForceParams>();
  o.port = parsed.params<haptics::PortParams>();
  o.free = parsed.params<haptics::FreeParams>();
  o.tool = parsed.params<haptics::ToolParams>();
  o.shaft = parsed.params<haptics::ShaftParams>();
  o.target = parsed.params<haptics::TargetParams>();
  o.drilling = parsed.params<haptics::DrillingParams>();
  o.law = parsed.params<drill::DrillParams>();
  o.sound = parsed.params<sound::LiveSoundParams>();
  o.record = parsed.path("record");
  return o;
}

// "a, b, or c": what --device may be, as the kinds say it themselves.
std::string devices_text() {
  const std::vector<device::DeviceType>& all = device::device_types();
  std::string text;
  for (const device::DeviceType& type : all)
    text += (text.empty() ? "" : &type == &all.back() ? ", or " : ", ") + type.help;
  return text;
}

std::vector<cli::Argument> session_arguments(const std::string& own) {
  cli::Argument folder = cli::argument("case", cli::Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  cli::Argument device =
      cli::argument("device", cli::Argument::Kind::choice, "Who holds the tool; " + own + " where it is not given.");
  std::vector<cli::Argument> all = {folder, device};
  for (const device::DeviceType& type : device::device_types()) {
    all[1].choices.push_back(type.name);
    all.insert(all.end(), type.files.begin(), type.files.end());
  }
  if (std::find(all[1].choices.begin(), all[1].choices.end(), own) == all[1].choices.end())
    all[1].choices.push_back(own);
  all.push_back(cli::argument("shape", cli::Argument::Kind::text,
                              "The only shape that is felt; without it, all shapes of the case."));
  all.push_back(cli::argument("record", cli::Argument::Kind::out_file, "Write every tick to this file."));
  return all;
}

std::vector<cli::Argument> measuring_arguments() {
  std::vector<cli::Argument> all = session_arguments(device::DeviceChoice().name);
  all.erase(std::remove_if(all.begin(), all.end(), [](const cli::Argument& a) { return a.name == "record"; }),
            all.end());
  return all;
}

device::DeviceScene touched_scene(const session::Patient& patient, bool in_real_time,
                                  std::function<void(const std::string&)> say) {
  return {patient.contact,
          haptics::touchable_of(patient.felt.feels),
          in_real_time,
          false,
          [say = std::move(say)](const texts::Note& note) { say(texts::text_of(note, texts::Language::english)); },
          Progress({}, &cancel_requested()),
          0,
          0,
          {}};
}

cli::Argument before_argument() {
  cli::Argument before =
      cli::argument("before", cli::Argument::Kind::in_file,
                    "A recording that came before on the same patient, in their order; needed where another "
                    "tool was taken after something had been cut.");
  before.repeated = true;
  return before;
}

std::vector<cli::ParameterGroup> session_groups() {
  std::vector<cli::ParameterGroup> all = {
      cli::ParameterGroup::of<haptics::ServoParams>("Servo loop"),
      cli::ParameterGroup::of<contact::ContactParams>("Contact"),
      cli::ParameterGroup::of<haptics::ForceParams>("Force"),
      cli::ParameterGroup::of<haptics::PortParams>("Jumps, gaps and delay of the device"),
      cli::ParameterGroup::of<haptics::FreeParams>("What is felt everywhere"),
      cli::ParameterGroup::of<haptics::ToolParams>("Tool"),
      cli::ParameterGroup::of<haptics::ShaftParams>("Its shaft"),
      cli::ParameterGroup::of<haptics::TargetParams>("A target to follow"),
      cli::ParameterGroup::of<haptics::DrillingParams>("Drilling"),
      cli::ParameterGroup::of<drill::DrillParams>("The law of removal"),
      cli::ParameterGroup::of<sound::LiveSoundParams>("Sound of the drill"),
      cli::ParameterGroup::of<device::WorkspaceParams>("The device's workspace")};
  for (const device::DeviceType& type : device::device_types())
    all.insert(all.end(), type.groups.begin(), type.groups.end());
  return all;
}

}  // namespace trephine::commands
