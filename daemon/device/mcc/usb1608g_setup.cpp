// SPDX-License-Identifier: Apache-2.0
// Models, packet sizes and options of the USB-1608G family.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/clock.h"
#include "device/mcc/description.h"
#include "device/mcc/uri_choices.h"
#include "device/mcc/usb1608g.h"
#include "device/usb/usb_daq.h"

namespace dts::device::mcc {
namespace {

constexpr std::array kRangesV = {5.0, 10.0, 2.0, 1.0};
constexpr std::size_t kInputs = 16;
constexpr double kLongestPacketNs = 10e6;

constexpr Usb1608gModel row(std::uint16_t first, std::uint16_t second, std::string_view name, std::string_view uri, double max_hz) {
  return {.revisions = {{{kVendor, first, name, uri}, {kVendor, second, name, uri}}}, .max_aggregate_hz = max_hz};
}

constexpr std::array kGModels = {
    row(0x0110, 0x0134, "USB-1608G", "mcc:1608g", 250e3),
    row(0x0111, 0x0135, "USB-1608GX", "mcc:1608gx", 500e3),
    row(0x0112, 0x0136, "USB-1608GX-2AO", "mcc:1608gx-2ao", 500e3),
};

}  // namespace

std::span<const Usb1608gModel> usb_1608g_models() noexcept { return kGModels; }

GPackets choose_g_packets(const StreamLoad& load, const usb::ScanRequest& request) {
  const double longest_ns = std::min(kLongestPacketNs, static_cast<double>(request.latency_ns));
  const std::size_t codes_per_full = load.packet_bytes / 2;
  const std::size_t most_scans = codes_per_full / load.channels;
  const double wanted_scans = std::floor(longest_ns * load.scan_hz / core::kNanosecondsPerSecond);
  const bool fills_in_time = wanted_scans * static_cast<double>(load.channels) >= static_cast<double>(codes_per_full);
  if (fills_in_time || request.must_use_large_packets || most_scans == 0) {
    return {.packet_codes = codes_per_full, .transfers = block_transfers(load, request.latency_ns)};
  }
  const double scans = std::clamp(wanted_scans, 1.0, static_cast<double>(most_scans));
  return {.packet_codes = static_cast<std::size_t>(scans) * load.channels,
          .transfers = immediate_transfers(load.packet_bytes, load.scan_hz / scans)};
}

std::vector<UriOption> usb_1608g_options() {
  std::vector<UriOption> options = usb::common_daq_options();
  options.push_back(trigger_option());
  options.push_back(sync_output_option());
  options.push_back({.name = "fpga",
                     .kind = OptionKind::File,
                     .default_text = {},
                     .minimum = 0.0,
                     .maximum = 0.0,
                     .choices = {},
                     .sentence = "MCC's FPGA image for this unit, loaded after each power-up."});
  return options;
}

core::Result<std::unique_ptr<Device>> create_usb_1608g(const Usb1608gModel& model, const DeviceUri& uri, const DeviceContext& context) {
  if (context.usb == nullptr) return tl::make_unexpected(no_usb(uri));
  const std::vector<UriOption> table = usb_1608g_options();
  DTS_TRY_ASSIGN(const auto options, UriOptions::read(uri, table));
  const usb::DaqLimits limits{.inputs = kInputs, .max_scan_length = kScanListBytes, .must_ascend = false, .ranges_v = kRangesV};
  DTS_TRY_ASSIGN(auto common, usb::read_daq_options(uri, options, limits));
  if (options.is_given("fpga")) {  // so that --check-config reports a wrong file
    if (!std::filesystem::path(options.text("fpga")).is_absolute()) {
      return core::fail(core::ErrorCode::InvalidArgument,
                        "device \"" + uri.text + "\": fpga = \"" + options.text("fpga") + "\" is not an absolute path",
                        "write an absolute path, for example fpga=/etc/dtsd/usb1608g.bit: dtsd may start in any folder");
    }
    if (auto checked = check_fpga_file(options.text("fpga")); !checked) {
      core::Error error = checked.error();
      error.what = "device \"" + uri.text + "\": " + error.what;
      return tl::make_unexpected(error);
    }
  }
  Usb1608gSettings settings{.options = common,
                            .trigger = read_trigger(options),
                            .sync_output_bit = read_sync_output_bit(options),
                            .fpga_path = options.text("fpga")};
  return std::make_unique<usb::UsbDaq>(std::make_unique<Usb1608g>(model, std::move(settings)), common, *context.usb, context.clock);
}

}  // namespace dts::device::mcc
