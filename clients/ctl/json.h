// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "cli/json.h"
#include "dts/stream.h"
#include "dts/wire/options.h"

namespace dts::ctl {

/// Converts a wire message to JSON: keys are the field names of the .proto files, enumerators are lower-case words ("streaming"). Undefined
/// values are absent: fields that are not set, empty strings, unspecified enumerators and numbers that are not finite.
[[nodiscard]] cli::Json to_json(const google::protobuf::Message& message);

/// Returns {"kind": "gap", fields of the gap...}.
[[nodiscard]] cli::Json event_json(std::string_view kind, const v1::Event& event);

using wire::enumerator_word;

/// Return bits as words: of any enumeration of bits, and of v1::Quality, for example {"rail", "untared"}.
[[nodiscard]] std::vector<std::string> bit_words(const google::protobuf::EnumDescriptor& type, std::uint32_t bits);
[[nodiscard]] std::vector<std::string> quality_words(std::uint8_t bits);

}  // namespace dts::ctl
