// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <string_view>
#include <vector>

namespace dts::golden {

/// One line of text for a message: "<kind> <topic> key=value ...". Blocks of a stream are summed up, everything else is complete.
[[nodiscard]] std::string line_of(std::string_view topic, const google::protobuf::Message& message);

/// Where the two differ: "line 12, p1.value_mm: expected 3.1, got 3.2". At most `most` of them.
[[nodiscard]] std::vector<std::string> differences(const std::vector<std::string>& expected, const std::vector<std::string>& got,
                                                   std::size_t most);
[[nodiscard]] std::vector<std::string> lines_of(const std::string& text);

}  // namespace dts::golden
