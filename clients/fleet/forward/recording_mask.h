// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "core/result.h"
#include "fleet/wire/facts.h"
#include "record/xdf/chunk_stream.h"

namespace dts::fleet::forward {

/// Masks the texts of a recording that must stay in the clinic, chunk by chunk: label, fields of the protocol, texts of markers and reasons
/// become '#' of the same length. Numbers, and texts that programs make, stay. The result is the same for the same file and the same rules.
/// Thread: one.
class RecordingMask {
 public:
  explicit RecordingMask(wire::SendRules rules) : rules_(std::move(rules)) {}

  /// Appends the chunk, masked, to `out`. Chunks must arrive in the order of the file. Fails with DataDamaged for a chunk that dtsd does
  /// not write, because nobody knows which texts it holds.
  [[nodiscard]] core::Status append(const record::RawChunk& chunk, std::string& out);

 private:
  [[nodiscard]] core::Status mask_header(std::string& bytes, std::size_t begin) const;
  [[nodiscard]] core::Status mask_texts(std::string& bytes, std::size_t begin) const;
  [[nodiscard]] bool is_sent(const std::string& fact) const;

  wire::SendRules rules_;
  std::set<std::uint32_t> text_streams_;
  std::set<std::uint32_t> number_streams_;
};

}  // namespace dts::fleet::forward
