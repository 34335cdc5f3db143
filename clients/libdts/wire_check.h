// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "dts/error.h"
#include "dts/stream.h"
#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"

namespace dts::client {

/// Nothing the daemon publishes is larger; a block of its largest size has 512 KiB.
inline constexpr std::size_t kMaxMessageBytes = 1U << 20U;

/// An answer may hold a whole list: a thousand sessions, ten thousand trials.
inline constexpr std::size_t kMaxAnswerBytes = 4 * kMaxMessageBytes;

/// The daemon is checked like any other peer: everything that is used as a size, a divisor or a name must make sense.
/// Each fails with DataDamaged and what is wrong.
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
/// Whatever it answers.
[[nodiscard]] Result<void> check(const v1::Response& response);

/// No error text: this one runs per block.
[[nodiscard]] bool is_well_formed(const v1::StreamBlock& block) noexcept;
[[nodiscard]] bool is_well_formed(const v1::Rate& rate) noexcept;

}  // namespace dts::client
