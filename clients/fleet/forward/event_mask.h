// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "dts/v1/stream.pb.h"
#include "fleet/wire/facts.h"

namespace dts::fleet::forward {

inline constexpr char kMask = '#';

/// Masks the texts of a recorded event that must stay in the clinic: every byte of such a text becomes '#', so that the length of the
/// recording stays the same. An allow-list of fields decides; a new field of Event stays in the clinic until it is added there. `json` is
/// an event as dtsd records it now or as dtsd 0.1 did. Any other text is masked completely. Thread: any.
void mask_event(std::span<char> json, const wire::SendRules& rules);

/// Removes the same texts from an event that is sent live.
void mask_event(v1::Event& event, const wire::SendRules& rules);

}  // namespace dts::fleet::forward
