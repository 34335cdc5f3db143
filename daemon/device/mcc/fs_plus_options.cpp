// SPDX-License-Identifier: Apache-2.0
// Options of "mcc:1608fs-plus?", and creation of the device.
#include "device/mcc/fs_plus.h"
#include "device/mcc/uri_choices.h"
#include "device/usb/usb_daq.h"

namespace dts::device::mcc {

usb::DaqLimits limits_of(const FsPlusModel& model) {
  return {.inputs = kFsPlusInputs, .max_scan_length = kFsPlusInputs, .must_ascend = true, .ranges_v = model.ranges_v};
}

std::vector<UriOption> fs_plus_options(const FsPlusModel& model) {
  std::vector<UriOption> options = usb::common_daq_options();
  options.push_back(trigger_option());
  options.push_back(sync_output_option());
  if (model.has_sync_pin) {
    options.push_back({.name = "sync_pin",
                       .kind = OptionKind::Word,
                       .default_text = "off",
                       .choices = "off|out",
                       .sentence = "out: a pulse per scan on the SYNC pin."});
  }
  return options;
}

core::Result<std::unique_ptr<Device>> create_fs_plus(const FsPlusModel& model, const DeviceUri& uri, const DeviceContext& context) {
  if (context.usb == nullptr) return tl::make_unexpected(no_usb(uri));
  const std::vector<UriOption> table = fs_plus_options(model);
  DTS_TRY_ASSIGN(const auto options, UriOptions::read(uri, table));
  DTS_TRY_ASSIGN(auto common, usb::read_daq_options(uri, options, limits_of(model)));
  FsPlusSettings settings{.options = common, .trigger = read_trigger(options), .sync_output_bit = read_sync_output_bit(options)};
  if (model.has_sync_pin && options.text("sync_pin") == "out") settings.sync = SyncPin::Output;
  return std::make_unique<usb::UsbDaq>(std::make_unique<FsPlus>(model, std::move(settings)), common, *context.usb, context.clock);
}

}  // namespace dts::device::mcc
