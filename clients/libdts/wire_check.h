// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "dts/error.h"
#include "dts/stream.h"
#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"

namespace dts::client {

/// No published message is larger; the largest block has 512 KiB.
inline constexpr std::size_t kMaxMessageBytes = 1U << 20U;

/// Limit for answers, which may hold a whole list: a thousand sessions, ten thousand trials.
inline constexpr std::size_t kMaxAnswerBytes = 4 * kMaxMessageBytes;

/// Checks of the daemon's answers: the client does not trust the daemon more than any other peer. Every value used as a size, a divisor or
/// a name must be valid. Each function fails with DataDamaged and the reason.
[[nodiscard]] Result<void> check(const v1::RigInfo& rig);
[[nodiscard]] Result<void> check(const v1::StatusSnapshot& status);
[[nodiscard]] Result<void> check(const v1::ListRigsResponse& rigs);
[[nodiscard]] Result<void> check(const v1::GetDevicesResponse& devices);
[[nodiscard]] Result<void> check(const v1::TestDeviceResponse& test);
[[nodiscard]] Result<void> check(const v1::SessionInfo& session);
[[nodiscard]] Result<void> check(const v1::MarkResponse& mark);
[[nodiscard]] Result<void> check(const v1::TareResponse& tare);
[[nodiscard]] Result<void> check(const v1::TrialStatus& trial);
[[nodiscard]] Result<void> check(const v1::SessionRecord& session);
[[nodiscard]] Result<void> check(const v1::ListSessionsResponse& sessions);
[[nodiscard]] Result<void> check(const v1::ListProtocolsResponse& protocols);
[[nodiscard]] Result<void> check(const v1::GetAuditResponse& audit);
[[nodiscard]] Result<void> check(const v1::ListKeysResponse& keys);
/// Checks the answer that the response holds, for every command.
[[nodiscard]] Result<void> check(const v1::Response& response);

/// Returns no error text, because it runs for every block.
[[nodiscard]] bool is_well_formed(const v1::StreamBlock& block) noexcept;
[[nodiscard]] bool is_well_formed(const v1::Rate& rate) noexcept;

}  // namespace dts::client
