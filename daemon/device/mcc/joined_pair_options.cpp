// SPDX-License-Identifier: Apache-2.0
// Options of "mcc:1608fs-plus-pair?", and creation of the pair.
#include <algorithm>
#include <string_view>

#include "device/mcc/description.h"
#include "device/mcc/fs_plus.h"
#include "device/mcc/joined_pair.h"
#include "device/mcc/uri_choices.h"
#include "device/usb/usb_daq.h"

namespace dts::device::mcc {
namespace {

constexpr std::string_view kSecond = "second_";

/// Returns the options of one unit as a separate URI; errors still quote the whole URI.
DeviceUri part_of(const DeviceUri& uri, bool is_second) {
  DeviceUri part = uri;
  part.options.clear();
  for (const auto& [key, value] : uri.options) {
    if (key.starts_with(kSecond) == is_second) part.options[is_second ? key.substr(kSecond.size()) : key] = value;
  }
  return part;
}

std::vector<UriOption> options_of(bool is_second) {
  std::vector<UriOption> options = usb::common_daq_options();
  if (is_second) return options;
  options.push_back(trigger_option());
  options.push_back(sync_output_option());
  return options;
}

core::Result<FsPlusSettings> read_settings(const DeviceUri& uri, bool is_second) {
  const DeviceUri part = part_of(uri, is_second);
  const std::vector<UriOption> table = options_of(is_second);
  const auto options = UriOptions::read(part, table);
  const auto say_which = [is_second](core::Error error) {
    if (is_second) error.what += " (of the second unit: its options begin with \"second_\")";
    return tl::make_unexpected(error);
  };
  if (!options) return say_which(options.error());
  auto common = usb::read_daq_options(part, *options, limits_of(usb_1608fs_plus()));
  if (!common) return say_which(common.error());
  FsPlusSettings settings{.options = *common, .sync = is_second ? SyncPin::Input : SyncPin::Output, .sync_output_bit = {}};
  if (is_second) return settings;
  settings.trigger = read_trigger(*options);
  settings.sync_output_bit = read_sync_output_bit(*options);
  return settings;
}

DeviceDescription describe_pair(const FsPlusSettings& first, const FsPlusSettings& second) {
  const FsPlusModel& model = usb_1608fs_plus();
  usb::DaqOptions numbered_on = second.options;
  for (std::size_t& channel : numbered_on.channels) channel += kFsPlusInputs;
  const double first_hz = largest_scan_hz(model, first.options.channels.size());
  const double second_hz = largest_scan_hz(model, second.options.channels.size());
  DeviceDescription pair = describe_unit(std::string(model.usb.name) + " pair", first.options, model.bits, std::min(first_hz, second_hz));
  const DeviceDescription other = describe_unit(model.usb.name, numbered_on, model.bits, second_hz);
  pair.has_sync_output = first.sync_output_bit.has_value();
  pair.serial = first.options.serial + "+" + second.options.serial;
  pair.channels.insert(pair.channels.end(), other.channels.begin(), other.channels.end());
  return pair;
}

}  // namespace

core::Result<std::unique_ptr<Device>> create_pair(const DeviceUri& uri, const DeviceContext& context) {
  if (context.usb == nullptr) return tl::make_unexpected(no_usb(uri));
  DTS_TRY_ASSIGN(const auto first, read_settings(uri, false));
  DTS_TRY_ASSIGN(const auto second, read_settings(uri, true));
  FsPlusSettings follower = second;
  follower.is_partner_triggered = first.trigger != Trigger::None;
  const std::string& first_serial = first.options.serial;
  if (first_serial.empty() || second.options.serial.empty() || first_serial == second.options.serial) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "device \"" + uri.text + "\": a pair needs two different serial numbers: serial and second_serial",
                      "set serial to the unit that drives the SYNC wire; dtsctl device list shows the units that are plugged in");
  }
  const FsPlusModel& model = usb_1608fs_plus();
  auto master = std::make_unique<usb::UsbDaq>(std::make_unique<FsPlus>(model, first), first.options, *context.usb, context.clock);
  auto confirm = [unit = master.get()] { return unit->confirm_stopped(); };
  PairParts parts{
      .master = std::move(master),
      .slave = std::make_unique<usb::UsbDaq>(std::make_unique<FsPlus>(model, follower), second.options, *context.usb, context.clock),
      .confirm_master_stopped = std::move(confirm),
      .description = describe_pair(first, second)};
  return std::make_unique<JoinedPair>(std::move(parts), context.clock);
}

}  // namespace dts::device::mcc
