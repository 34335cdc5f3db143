// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_reaches.h"

#include <gtest/gtest.h>

#include "events/make.h"
#include "support/event_text.h"

namespace dts::session {
namespace {

using test::event_of;

/// A recording that holds events only.
class Events final : public record::Recording {
 public:
  explicit Events(std::vector<v1::Event> events) : events_(std::move(events)) {
    facts_ = record::SessionFacts{};
    facts_->fields = {{"weight_kg", "68"}, {"height_cm", "175"}, {"arm_length_cm", "67"}, {"max_reach_cm", "124"}};
  }
  [[nodiscard]] const std::vector<record::StreamInfo>& streams() const noexcept override { return streams_; }
  [[nodiscard]] std::optional<std::size_t> find_stream(const std::string&) const override { return std::nullopt; }
  [[nodiscard]] const std::optional<record::SessionFacts>& session() const noexcept override { return facts_; }
  [[nodiscard]] const std::string& damage() const noexcept override { return damage_; }
  [[nodiscard]] const core::Losses& losses() const noexcept override { return losses_; }
  [[nodiscard]] double duration_s() const noexcept override { return 0.0; }
  [[nodiscard]] std::uint64_t sample_count(std::size_t) const override { return 0; }
  [[nodiscard]] core::Result<std::optional<record::RecordedItem>> next() override {
    if (next_ == events_.size()) return std::optional<record::RecordedItem>{};
    return std::optional<record::RecordedItem>(record::TimedEvent{.time_s = 0.0, .event = events_[next_++]});
  }
  core::Status rewind() override {
    next_ = 0;
    return {};
  }
  [[nodiscard]] std::uint64_t offset() const noexcept override { return next_; }
  [[nodiscard]] std::uint64_t size() const noexcept override { return events_.size(); }

 private:
  std::vector<v1::Event> events_;
  std::vector<record::StreamInfo> streams_;
  core::Losses losses_;
  std::optional<record::SessionFacts> facts_;
  std::string damage_;
  std::size_t next_ = 0;
};

v1::Event trial(const std::string& step, std::int64_t number, std::uint64_t scan) {
  return event_of("segment: 2 scan: " + std::to_string(scan) + " trial { step: TRIAL_EVENT_KIND_" + step +
                  " trial: " + std::to_string(number) + " attempt: 1 block: 1 condition: '150' target_cm: 100.5 }");
}

core::ReachEvent reach(std::uint32_t number, std::uint64_t p1) {
  core::ReachEvent event{.step = core::ReachStep::Final, .number = number, .segment = 2, .scan = {p1 + 110}};
  event.features.p1_mm = 3.0;
  event.features.p2_mm = 2.7;
  event.features.p3_mm = 4.0;
  event.p1 = {{p1}, 3.0};
  event.p2 = {{p1 + 20}, 2.7};
  event.p3 = {{p1 + 60}, 4.0};
  return event;
}

v1::Event classed(std::uint32_t number, std::uint64_t p1, core::TrunkClass trunk_class) {
  core::ClassEvent event{.number = number, .segment = 2, .scan = {p1 + 110}};
  event.movement.trunk_class = trunk_class;
  event.movement.probability = {0.0, 1.0, 0.0};
  event.movement.trunk_deg = 25.0;
  event.movement.trunk_lo_deg = 20.0;
  event.movement.trunk_hi_deg = 30.0;
  return events::make(event, "");
}

core::Result<RecordedReaches> read(std::vector<v1::Event> events) {
  Events recording(std::move(events));
  return read_recorded_reaches(recording, nullptr, [](double) {});
}

TEST(RecordedReaches, Events_BecomeResults) {
  const auto recorded = read({trial("GO", 1, 1000), events::make(reach(1, 1100), ""), classed(1, 1100, core::TrunkClass::Moderate),
                              trial("DONE", 1, 1600), event_of("segment: 2 scan: 1700 marker {}")});
  ASSERT_TRUE(recorded) << recorded.error().what;
  EXPECT_EQ(recorded->reaches, 1U);
  ASSERT_EQ(recorded->trials.size(), 1U);
  EXPECT_EQ(recorded->trials[0].movement->trunk_class, core::TrunkClass::Moderate);
  EXPECT_EQ(recorded->trials[0].expected, core::TrunkClass::Moderate);
  EXPECT_DOUBLE_EQ(recorded->trials[0].reach->features.d2_mm(), 1.0);
}

TEST(RecordedReaches, OrderInTheFile_DoesNotMatter) {
  const auto recorded =
      read({trial("DONE", 1, 1600), classed(1, 1100, core::TrunkClass::Moderate), trial("GO", 1, 1000), events::make(reach(1, 1100), "")});
  ASSERT_TRUE(recorded) << recorded.error().what;
  ASSERT_EQ(recorded->trials.size(), 1U);
  EXPECT_TRUE(recorded->trials[0].movement.has_value());
}

/// As the daemon records it when it tells it.
v1::Event result(int trial, int number, int trunk_class, double trunk_deg) {
  return event_of("segment: 2 scan: 1700 trial_result { trial: " + std::to_string(trial) +
                  " attempt: 1 reach { number: " + std::to_string(number) + " } movement { trunk_class: " + std::to_string(trunk_class) +
                  " trunk_deg: " + std::to_string(trunk_deg) + " } }");
}

TEST(RecordedReaches, ResultsThatWereTold_AreComparedWithWhatIsComputed) {
  const std::vector<v1::Event> events{trial("GO", 1, 1000), events::make(reach(1, 1100), ""), classed(1, 1100, core::TrunkClass::Moderate),
                                      trial("DONE", 1, 1600)};
  const auto with = [&](const v1::Event& live) {
    auto all = events;
    all.push_back(live);
    const auto recorded = read(std::move(all));
    EXPECT_TRUE(recorded && recorded->live_results == 1U);
    return recorded ? recorded->differing : 99U;
  };
  EXPECT_EQ(with(result(1, 1, 2, 25.0)), 0U);
  EXPECT_EQ(with(result(1, 1, 3, 25.0)), 1U);
  EXPECT_EQ(with(result(1, 1, 2, 25.1)), 1U);
  EXPECT_EQ(with(result(1, 2, 2, 25.0)), 1U);
}

TEST(RecordedReaches, LongSession_LosesNoTrial) {
  std::vector<v1::Event> events;
  for (std::int64_t k = 1; k <= 3000; ++k) {
    const auto go = static_cast<std::uint64_t>(k) * 1000;
    events.push_back(trial("GO", k, go));
    events.push_back(events::make(reach(static_cast<std::uint32_t>(k), go + 100), ""));
    events.push_back(trial("DONE", k, go + 600));
  }
  const auto recorded = read(std::move(events));
  ASSERT_TRUE(recorded) << recorded.error().what;
  ASSERT_EQ(recorded->trials.size(), 3000U);
  for (const auto& result : recorded->trials) ASSERT_TRUE(result.reach.has_value()) << result.trial;
}

TEST(RecordedReaches, DamagedEvents_AreNamed) {
  for (const auto& [text, field] : {std::pair{"trial { step: 99 trial: 1 attempt: 1 }", "\"step\""},
                                    {"reach { step: REACH_STEP_FINAL flags: 70000 }", "\"flags\""},
                                    {"movement { trunk_class: 9 }", "\"trunk_class\""}}) {
    const auto recorded = read({event_of(text)});
    ASSERT_FALSE(recorded) << text;
    EXPECT_EQ(recorded.error().code, core::ErrorCode::DataDamaged);
    EXPECT_NE(recorded.error().what.find(field), std::string::npos) << recorded.error().what;
  }
}

}  // namespace
}  // namespace dts::session
