// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "cli/json.h"
#include "dts/stream.h"

namespace dts::ctl {

/// A wire message as JSON: keys are the field names of the .proto files, enumerators are lower-case words ("streaming").
/// What is undefined is absent: unset messages, empty strings, unspecified enumerators, numbers that are not finite, and
/// the few numbers whose 0 means "unknown" (listed in json.cpp).
[[nodiscard]] cli::Json to_json(const google::protobuf::Message& message);

/// {"kind": "gap", fields of the gap...}
[[nodiscard]] cli::Json event_json(std::string_view kind, const v1::Event& event);

/// The word for an enumerator: "DEVICE_STATE_STREAMING" to "streaming"; "unknown" for a number of a later version.
[[nodiscard]] std::string enumerator_word(const google::protobuf::EnumDescriptor& type, int number);

/// The bits of v1::Quality as words: {"rail", "untared"}.
/// The same of any enumeration of bits.
[[nodiscard]] std::vector<std::string> bit_words(const google::protobuf::EnumDescriptor& type, std::uint32_t bits);
[[nodiscard]] std::vector<std::string> quality_words(std::uint8_t bits);

}  // namespace dts::ctl
