// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "record/recording.h"

namespace dts::report {

/// A recording that notes the starts of its segments while it is read, and that fails when the caller no longer wants the result.
class WatchedRecording final : public record::Recording {
 public:
  /// Calls `wants_more` from time to time. Both arguments must outlive this object.
  WatchedRecording(record::Recording& recording, std::function<bool()> wants_more)
      : recording_(recording), wants_more_(std::move(wants_more)) {}

  [[nodiscard]] const std::vector<record::StreamInfo>& streams() const noexcept override { return recording_.streams(); }
  [[nodiscard]] std::optional<std::size_t> find_stream(const std::string& name) const override { return recording_.find_stream(name); }
  [[nodiscard]] const std::optional<record::SessionFacts>& session() const noexcept override { return recording_.session(); }
  [[nodiscard]] const std::string& damage() const noexcept override { return recording_.damage(); }
  [[nodiscard]] const core::Losses& losses() const noexcept override { return recording_.losses(); }
  [[nodiscard]] double duration_s() const noexcept override { return recording_.duration_s(); }
  [[nodiscard]] std::uint64_t sample_count(std::size_t stream) const override { return recording_.sample_count(stream); }
  [[nodiscard]] core::Result<std::optional<record::RecordedItem>> next() override;
  core::Status rewind() override { return recording_.rewind(); }
  [[nodiscard]] std::uint64_t offset() const noexcept override { return recording_.offset(); }
  [[nodiscard]] std::uint64_t size() const noexcept override { return recording_.size(); }

  /// Returns the time of a scan of the raw stream, in CLOCK_MONOTONIC; nothing if the start of the segment was not recorded.
  [[nodiscard]] std::optional<std::int64_t> host_time_ns(std::uint32_t segment, core::ScanIndex scan, double raw_rate_hz) const;

 private:
  struct Beginning {
    core::ScanIndex scan;
    std::int64_t host_time_ns = 0;
  };
  void note(const v1::Event& event);

  record::Recording& recording_;
  std::function<bool()> wants_more_;
  std::map<std::uint32_t, Beginning> segments_;
};

}  // namespace dts::report
