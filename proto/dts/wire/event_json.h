// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

#include <optional>
#include <string>
#include <string_view>

#include "dts/v1/stream.pb.h"

/// Events as JSON: the form in which recordings and the catalogue hold them. It is protobuf's own JSON with the field names of the .proto
/// files. 64-bit integers are texts; numbers read back as the same double; what is absent in the message is absent here. Thread: any.
namespace dts::wire {

inline constexpr std::size_t kLongestEventJson = std::size_t{64} << 10U;

/// Returns one line, always the same for the same message. Drops bytes that are not UTF-8.
[[nodiscard]] std::string to_json(const google::protobuf::Message& message);

/// Reads an event from any source. Returns nothing if the text has more than 64 KiB, is not JSON of an event, has a value of another type
/// or a number out of range, or has no body that this version knows. Skips keys and names of enumerators that this version does not know.
[[nodiscard]] std::optional<v1::Event> event_of_json(std::string_view text);

}  // namespace dts::wire
