// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::device {

/// "scheme:name?key=value&key=value": selects and configures a device.
struct DeviceUri {
  std::string scheme;                          ///< "sim"
  std::string name;                            ///< "floor"
  std::map<std::string, std::string> options;  ///< {"seed": "7"}
  std::string text;                            ///< As the user wrote it.

  /// Parses `text`. Fails with InvalidArgument, naming the wrong part, if the text is not of that form or a key occurs twice.
  [[nodiscard]] static core::Result<DeviceUri> parse(std::string_view text);
};

}  // namespace dts::device
