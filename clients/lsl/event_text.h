// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "dts/stream.h"

/// Samples of a rig's outlet "<rig>/events": JSON of one event, as the stream "<rig>/events" of dtsd's recordings has it. Thread: any.
namespace dts::lsl {

/// Returns the event without what identifies a person: subject ID and label. LSL has no authentication.
[[nodiscard]] std::string event_text(const v1::Event& event);
/// Returns the text for scans of a stream that this program did not receive: the loss is before the first scan of `block`.
[[nodiscard]] std::string loss_text(const client::Block& block);
/// Returns the text for a restart of dtsd: segments and scan indices start again.
[[nodiscard]] std::string restart_text(std::int64_t host_ns);

/// Returns false for what happens twice a second: preliminary measures of steadiness. Recordings do not have them either.
[[nodiscard]] bool is_offered(const v1::Event& event) noexcept;

}  // namespace dts::lsl
