// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "core/result.h"
#include "dts/v1/fleet.pb.h"

namespace dts::fleet::wire {

inline constexpr std::size_t kSha256Bytes = 32;
inline constexpr std::size_t kLargestChunk = 256 * 1024;
inline constexpr std::uint64_t kLargestFile = 1ULL << 40U;  ///< 1 TiB.
inline constexpr std::size_t kLargestMessage = 900 * 1024;  ///< nats-server's limit is 1 MiB.

/// Decode a message of a peer, which is not trusted: sizes, counts, numbers, enumerators and texts are checked. Fail with DataDamaged,
/// naming the field.
[[nodiscard]] core::Result<v1::UploadOffer> decode_offer(std::string_view bytes);
[[nodiscard]] core::Result<v1::UploadChunk> decode_chunk(std::string_view bytes);
[[nodiscard]] core::Result<v1::UploadCommit> decode_commit(std::string_view bytes);
[[nodiscard]] core::Result<v1::UploadAnswer> decode_upload_answer(std::string_view bytes);
[[nodiscard]] core::Result<v1::FleetSession> decode_session(std::string_view bytes);
[[nodiscard]] core::Result<v1::FactsAnswer> decode_facts_answer(std::string_view bytes);
[[nodiscard]] core::Result<v1::EraseSession> decode_erase(std::string_view bytes);
[[nodiscard]] core::Result<v1::EraseAnswer> decode_erase_answer(std::string_view bytes);
[[nodiscard]] core::Result<v1::Beat> decode_beat(std::string_view bytes);
[[nodiscard]] core::Result<v1::BeatAnswer> decode_beat_answer(std::string_view bytes);
[[nodiscard]] core::Result<v1::LiveRequest> decode_live_request(std::string_view bytes);
[[nodiscard]] core::Result<v1::LiveAnswer> decode_live_answer(std::string_view bytes);

/// SHA-256 as 64 hexadecimal digits, and back. `bytes_of_hex` fails with InvalidArgument for anything else.
[[nodiscard]] std::string hex_of(std::string_view sha256);
[[nodiscard]] core::Result<std::string> bytes_of_hex(std::string_view text);

}  // namespace dts::fleet::wire
