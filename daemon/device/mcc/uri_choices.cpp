// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/uri_choices.h"

#include <array>
#include <utility>

namespace dts::device::mcc {
namespace {

constexpr std::array<std::pair<std::string_view, Trigger>, 5> kTriggers = {{
    {"none", Trigger::None},
    {"rising", Trigger::Rising},
    {"falling", Trigger::Falling},
    {"high", Trigger::High},
    {"low", Trigger::Low},
}};

}  // namespace

UriOption trigger_option() {
  return {.name = "trigger",
          .kind = OptionKind::Word,
          .default_text = "none",
          .choices = "none|rising|falling|high|low",
          .sentence =
              "What the trigger input must do before the first scan. It is armed once, for the first scan after dtsd starts; after a "
              "fault or a replug the scan continues without it."};
}

Trigger read_trigger(const UriOptions& options) {
  for (const auto& [word, trigger] : kTriggers) {
    if (word == options.text("trigger")) return trigger;
  }
  return Trigger::None;
}

UriOption sync_output_option() {
  return {.name = "sync_output_bit",
          .kind = OptionKind::Integer,
          .default_text = "-1",
          .minimum = -1.0,
          .maximum = 7.0,
          .choices = {},
          .sentence = "Digital line for the sync pulses of a session, see [session] sync_pulse_ms; nothing while that is 0; -1: none."};
}

std::optional<unsigned> read_sync_output_bit(const UriOptions& options) {
  const double bit = options.number("sync_output_bit");
  return bit < 0.0 ? std::nullopt : std::optional(static_cast<unsigned>(bit));
}

core::Error no_usb(const DeviceUri& uri) {
  return {core::ErrorCode::Unsupported, "device \"" + uri.text + "\" is on a USB cable, and this program has no access to USB",
          "run it in dtsd, or use a \"sim:\" device"};
}

}  // namespace dts::device::mcc
