// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "device/device_entry.h"
#include "device/mcc/fs_plus_models.h"
#include "device/uri_options.h"

namespace dts::device::mcc {

/// Options of all MCC devices of this folder.
[[nodiscard]] UriOption trigger_option();
[[nodiscard]] Trigger read_trigger(const UriOptions& options);
[[nodiscard]] UriOption sync_output_option();
[[nodiscard]] std::optional<unsigned> read_sync_output_bit(const UriOptions& options);

/// Returns the error for a USB device in a program without USB.
[[nodiscard]] core::Error no_usb(const DeviceUri& uri);

}  // namespace dts::device::mcc
