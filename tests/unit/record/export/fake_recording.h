// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "record/recording.h"
#include "support/event_text.h"

namespace dts::record {

/// A recording made of what a test says, without a file.
class FakeRecording : public Recording {
 public:
  std::vector<StreamInfo> infos{};
  std::vector<RecordedItem> items{};
  std::optional<SessionFacts> facts{};
  std::string damaged{};
  core::Losses lost{};
  std::optional<std::size_t> fails_at{};  ///< `next` fails there.

  [[nodiscard]] const std::vector<StreamInfo>& streams() const noexcept override { return infos; }
  [[nodiscard]] std::optional<std::size_t> find_stream(const std::string& name) const override {
    for (std::size_t stream = 0; stream < infos.size(); ++stream) {
      if (infos[stream].name == name || short_name(infos[stream].name) == name) return stream;
    }
    return std::nullopt;
  }
  [[nodiscard]] const std::optional<SessionFacts>& session() const noexcept override { return facts; }
  [[nodiscard]] const std::string& damage() const noexcept override { return damaged; }
  [[nodiscard]] const core::Losses& losses() const noexcept override { return lost; }
  [[nodiscard]] double duration_s() const noexcept override { return 0.0; }
  [[nodiscard]] std::uint64_t sample_count(std::size_t stream) const override {
    std::uint64_t count = 0;
    for (const RecordedItem& item : items) {
      if (const auto* scans = std::get_if<RecordedScans>(&item)) count += scans->stream == stream ? scans->count : 0;
      if (const auto* change = std::get_if<RecordedChange>(&item)) count += change->stream == stream ? 1 : 0;
    }
    return count;
  }
  [[nodiscard]] core::Result<std::optional<RecordedItem>> next() override {
    if (fails_at == position_) return core::fail(core::ErrorCode::DataDamaged, "chunk torn");
    if (position_ == items.size()) return std::optional<RecordedItem>();
    return std::optional<RecordedItem>(items[position_++]);
  }
  core::Status rewind() override {
    position_ = 0;
    return {};
  }
  [[nodiscard]] std::uint64_t offset() const noexcept override { return position_ << 23U; }  // 8 MiB each
  [[nodiscard]] std::uint64_t size() const noexcept override { return items.size() << 23U; }

 private:
  std::size_t position_ = 0;
};

/// Two feet on the floor: raw (w1_v, w2_v) and cop (ml_mm, ap_mm, load_n) at 100 Hz, five scans of each and a marker; then a gap of a
/// second, and two scans of a second segment. All synthetic.
inline FakeRecording floor_recording() {
  const core::Rate rate = *core::Rate::create(100, 1);
  FakeRecording made;
  made.infos = {{.name = "floor/raw",
                 .content = "DTS",
                 .value_type = ValueType::Double64,
                 .rate = rate,
                 .channels = {{.label = "w1_v", .unit = "V"}, {.label = "w2_v", .unit = "V"}}},
                {.name = "floor/cop",
                 .content = "DTS",
                 .value_type = ValueType::Float32,
                 .rate = rate,
                 .channels = {{.label = "ml_mm", .unit = "mm"}, {.label = "ap_mm", .unit = "mm"}, {.label = "load_n", .unit = "N"}}},
                {.name = "floor/events", .content = "Markers", .value_type = ValueType::Text, .channels = {{.label = "event"}}},
                {.name = "floor/quality", .content = "Quality", .value_type = ValueType::Int8, .channels = {{.label = "w1_v"}}}};
  SessionFacts facts;
  facts.session_id = "20261121T144525Z-floor-1";
  facts.rig = "floor";
  facts.kind = "floor";
  facts.protocol = "quiet-standing";
  facts.subject = "P-017";
  facts.label = "Jane Doe";  // synthetic: what nobody should have typed
  facts.software = "dtsd 0.1.0";
  facts.device_serial = "SIM0001";
  facts.started_utc_ns = 1'795'272'325'000'000'000;
  facts.utc_minus_monotonic_ns = 1'795'272'000'000'000'000;
  made.facts = facts;
  made.lost.add(core::GapReason::Unplugged, {.gaps = 1, .scans = 100});
  const auto scans = [](std::size_t stream, std::uint32_t segment, std::uint64_t first, double time_s, std::size_t count,
                        std::size_t channels) {
    RecordedScans made_scans{
        .stream = stream, .segment = segment, .first_scan = {first}, .first_time_s = time_s, .count = count, .values = {}};
    for (std::size_t value = 0; value < count * channels; ++value) {
      made_scans.values.push_back(static_cast<double>(static_cast<float>(value) / 10.0F));
    }
    return made_scans;
  };
  const auto event = [](double time_s, const std::string& text) { return TimedEvent{.time_s = time_s, .event = test::event_of(text)}; };
  constexpr double kStart = 8123.251;
  made.items = {event(kStart, "host_time_ns: 8123251000000 segment_start {}"),
                RecordedChange{.stream = 3, .segment = 0, .scan = {0}, .time_s = kStart, .values = {0.0}},
                scans(0, 0, 0, kStart, 3, 2),
                scans(1, 0, 0, kStart, 3, 3),
                event(kStart + 0.02, "scan: 2 marker { text: 'eyes \"closed\", now' }"),
                scans(0, 0, 3, kStart + 0.03, 2, 2),
                scans(1, 0, 3, kStart + 0.03, 2, 3),
                event(kStart + 1.05, "segment: 1 segment_start { reason: GAP_REASON_UNPLUGGED missing_scans: 100 }"),
                scans(0, 1, 0, kStart + 1.05, 2, 2),
                scans(1, 1, 0, kStart + 1.05, 2, 3),
                RecordedChange{.stream = 3, .segment = 1, .scan = {1}, .time_s = kStart + 1.06, .values = {8.0}}};
  return made;
}

}  // namespace dts::record
