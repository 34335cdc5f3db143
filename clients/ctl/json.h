// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "dts/stream.h"

namespace dts::ctl {

using Json = nlohmann::ordered_json;

/// A wire message as JSON: keys are the field names of the .proto files, enumerators are lower-case words ("streaming").
/// What is undefined is absent: unset messages, empty strings, unspecified enumerators, numbers that are not finite, and
/// the few numbers whose 0 means "unknown" (listed in json.cpp).
[[nodiscard]] Json to_json(const google::protobuf::Message& message);

/// {"kind": "gap", fields of the gap...}
[[nodiscard]] Json event_json(std::string_view kind, const v1::Event& event);

/// The word for an enumerator: "DEVICE_STATE_STREAMING" to "streaming"; "unknown" for a number of a later version.
[[nodiscard]] std::string enumerator_word(const google::protobuf::EnumDescriptor& type, int number);

/// The bits of v1::Quality as words: {"rail", "untared"}.
[[nodiscard]] std::vector<std::string> quality_words(std::uint8_t bits);

/// Without line ends. Text that is not UTF-8 (a topic may be anything) is repaired, here and in `document`.
[[nodiscard]] std::string one_line(const Json& json);
/// One document, indented, with a line end.
[[nodiscard]] std::string document(const Json& json);

}  // namespace dts::ctl
