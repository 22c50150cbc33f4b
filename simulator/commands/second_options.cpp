// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/second_options.h"

#include <algorithm>
#include <map>
#include <memory>

#include "base/error.h"
#include "cli/argument.h"

namespace trephine::commands {
namespace {

const std::string prefix = "second_";

struct Prefixed {
  const ParameterSet* own;
  ParameterSet set;
};
// By the set itself, for as long as the program runs: commands refer to them.
std::map<const ParameterSet*, std::unique_ptr<Prefixed>>& all_prefixed() {
  static std::map<const ParameterSet*, std::unique_ptr<Prefixed>> all;
  return all;
}

// The same declaration with other names: an object of one is an object of the other.
const ParameterSet& prefixed(const ParameterSet& own) {
  std::unique_ptr<Prefixed>& p = all_prefixed()[&own];
  if (!p) {
    p = std::make_unique<Prefixed>(Prefixed{&own, own});
    for (Parameter& parameter : p->set.parameters) parameter.name = prefix + parameter.name;
    if (own.fault)
      p->set.fault = [fault = own.fault](const void* object) {
        const std::string what = fault(object);
        return what.empty() ? what : prefix + what;
      };
  }
  return p->set;
}

cli::ParameterGroup prefixed(const cli::ParameterGroup& own) {
  return {"Second hand: " + own.title, [make = own.make] {
            AnyParams params = make();
            params.set = &prefixed(*params.set);
            return params;
          }};
}

template <class P>
P second_params(const cli::ParsedCommand& parsed) {
  const ParameterSet& set = prefixed(parameters_of<P>());
  for (const AnyParams& g : parsed.groups)
    if (g.set == &set) return *static_cast<const P*>(g.object.get());
  throw Error(ExitCode::internal, "", "second", "the command has no such group");
}

}  // namespace

std::vector<cli::Argument> second_arguments() {
  std::vector<cli::Argument> all = {cli::argument(
      "second_device", cli::Argument::Kind::choice,
      "Who holds a second tool in the other hand; without it there is one hand. Its own flags begin with --second-.")};
  for (const device::DeviceType& type : device::device_types()) {
    if (type.first_only) continue;
    all[0].choices.push_back(type.name);
    for (cli::Argument file : type.files) {
      file.name = prefix + file.name;
      all.push_back(file);
    }
  }
  return all;
}

std::vector<cli::ParameterGroup> second_groups() {
  std::vector<cli::ParameterGroup> all = {
      prefixed(cli::ParameterGroup::of<haptics::ToolParams>("Tool")),
      prefixed(cli::ParameterGroup::of<haptics::ForceParams>("Force")),
      prefixed(cli::ParameterGroup::of<haptics::PortParams>("Jumps, gaps and delay of the device")),
      prefixed(cli::ParameterGroup::of<device::WorkspaceParams>("The device's workspace"))};
  for (const device::DeviceType& type : device::device_types())
    if (!type.first_only)
      for (const cli::ParameterGroup& group : type.groups) all.push_back(prefixed(group));
  return all;
}

std::optional<session::SecondOptions> second_options_of(const cli::ParsedCommand& parsed,
                                                        const device::DeviceChoice& first) {
  session::SecondOptions o;
  o.device.flags = "second-";
  for (const device::DeviceType& type : device::device_types())
    for (const cli::Argument& file : type.files)
      if (parsed.has(prefix + file.name)) o.device.files[file.name] = parsed.path(prefix + file.name);
  if (!parsed.has("second_device")) {
    std::string alone = o.device.files.empty() ? "" : prefix + o.device.files.begin()->first;
    for (const std::string& name : parsed.given)
      if (alone.empty() && name.compare(0, prefix.size(), prefix) == 0) alone = name;
    std::replace(alone.begin(), alone.end(), '_', '-');
    if (!alone.empty()) throw Error(ExitCode::usage, "", "--" + alone, "needs --second-device");
    return std::nullopt;
  }
  o.device.name = parsed.text("second_device");
  for (AnyParams group : parsed.groups)
    for (const auto& [own, of_second] : all_prefixed())
      if (group.set == &of_second->set) {
        group.set = own;
        o.device.params.push_back(group);
      }
  o.workspace = second_params<device::WorkspaceParams>(parsed);
  o.force = second_params<haptics::ForceParams>(parsed);
  o.port = second_params<haptics::PortParams>(parsed);
  haptics::ToolParams tool = second_params<haptics::ToolParams>(parsed);
  if (!parsed.given.count(prefix + "tool")) tool.tool = "suction";
  o.tool = session::second_tool(tool);
  session::require_two_devices(first, o.device);
  return o;
}

}  // namespace trephine::commands
