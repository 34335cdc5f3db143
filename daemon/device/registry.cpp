// SPDX-License-Identifier: Apache-2.0
#include "device/registry.h"

#include <algorithm>

#include "core/suggest.h"
#include "device/board/entries.h"
#include "device/labjack/u6.h"
#include "device/mcc/entries.h"
#include "device/nidaqmx/ni_daqmx.h"
#include "device/replay/replay_device.h"
#include "device/sim/chair/chair.h"
#include "device/sim/floor.h"
#include "device/sim/stack/stack.h"

namespace dts::device {
namespace {

/// An entry "sim:floor" matches this name only; an entry "ni:" matches any name, for example "Dev1".
bool is_meant(const RegistryEntry& entry, const DeviceUri& uri) {
  const std::string& known = entry.scheme_and_name;
  return known == uri.scheme + ":" + uri.name || known == uri.scheme + ":";
}

core::Error unknown_kind(const DeviceUri& uri) {
  std::vector<std::string_view> names;
  std::string list;
  for (const RegistryEntry& entry : registry()) {
    names.push_back(entry.scheme_and_name);
    list += "\n  " + entry.scheme_and_name + "  " + entry.sentence;
  }
  const std::string meant = core::suggest(uri.scheme + ":" + uri.name, names);
  return {core::ErrorCode::InvalidArgument, "device \"" + uri.text + "\": this program knows no such device",
          (meant.empty() ? "" : "did you mean \"" + meant + "\"? ") + "Known devices:" + list};
}

std::vector<RegistryEntry> with_families(std::vector<RegistryEntry> entries) {
  for (RegistryEntry& entry : mcc::registry_entries()) entries.push_back(std::move(entry));
  for (RegistryEntry& entry : board::registry_entries()) entries.push_back(std::move(entry));
  return entries;
}

}  // namespace

const std::vector<RegistryEntry>& registry() {
  static const std::vector<RegistryEntry> entries = with_families({
      {"sim:floor", "Simulated floor platform with a person or a weight on it.", sim::create_floor},
      {"sim:chair", "Simulated chair with a person who reaches.", sim::create_chair},
      {"sim:stack", "Simulated floor platform on a force plate, one person on both: one part of it.", sim::create_stack},
      {"replay:", "Plays a recording: replay:FILE.xdf?speed=1&loop=0.", replay::create_replay},
      {"labjack:u6", "LabJack U6 or U6-Pro: 14 inputs, one converter.", labjack::create_u6, labjack::u6_models()},
      {"ni:", "A device of National Instruments; needs NI-DAQmx: ni:Dev1.", nidaqmx::create_ni_daqmx},
  });
  return entries;
}

bool compete(std::string_view one_uri, std::string_view other_uri) {
  const auto one = DeviceUri::parse(one_uri);
  const auto other = DeviceUri::parse(other_uri);
  if (!one || !other || one->scheme != other->scheme || one->name != other->name) return false;
  if (one->scheme == "sim" || one->scheme == "replay" || one->scheme == "exec") return false;
  const auto first = one->options.find("serial");
  const auto second = other->options.find("serial");
  return first == one->options.end() || second == other->options.end() || first->second == second->second;
}

core::Result<std::unique_ptr<Device>> create_device(std::string_view uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(const auto parsed, DeviceUri::parse(uri));
  const auto& entries = registry();
  const auto entry = std::find_if(entries.begin(), entries.end(), [&](const RegistryEntry& known) { return is_meant(known, parsed); });
  if (entry == entries.end()) return tl::make_unexpected(unknown_kind(parsed));
  return entry->create(parsed, context);
}

}  // namespace dts::device
