// SPDX-License-Identifier: Apache-2.0
#include "lsl/outlets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/clock.h"
#include "lsl/event_text.h"

namespace dts::lsl {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// What dts-lsl has passed to the library.
struct FakeStream {
  std::string name;
  std::string source_id;
  std::int32_t channels = 0;
  double rate_hz = 0.0;
  std::int32_t format = 0;
  bool is_offered = false;
  std::string description;
  std::vector<float> values;
  std::vector<double> stamps_s;
  std::vector<std::string> texts;
};

/// A library in memory: functions of C have no object, so it is global to this file.
struct FakeLibrary {
  std::vector<std::unique_ptr<FakeStream>> streams;
  bool has_consumers = true;
  bool is_broken = false;  // no port is free

  [[nodiscard]] std::vector<std::string> offered() const {
    std::vector<std::string> names;
    for (const auto& stream : streams) {
      if (stream->is_offered) names.push_back(stream->name);
    }
    return names;
  }
  [[nodiscard]] FakeStream& of(const std::string& name) const {
    for (const auto& stream : streams) {
      if (stream->is_offered && stream->name == name) return *stream;
    }
    throw std::out_of_range(name);
  }
};
FakeLibrary fake_library;

Liblsl fake_functions() {
  Liblsl lsl;
  lsl.create_streaminfo = [](const char* name, const char*, std::int32_t channels, double rate_hz, std::int32_t format,
                             const char* source_id) -> api::Info {
    fake_library.streams.push_back(std::make_unique<FakeStream>(
        FakeStream{.name = name, .source_id = source_id, .channels = channels, .rate_hz = rate_hz, .format = format}));
    return fake_library.streams.back().get();
  };
  lsl.destroy_streaminfo = [](api::Info) {};
  lsl.get_desc = [](api::Info info) -> api::Xml { return info; };
  lsl.append_child = [](api::Xml node, const char* name) -> api::Xml {
    static_cast<FakeStream*>(node)->description += std::string(name) + ";";
    return node;
  };
  lsl.append_child_value = [](api::Xml node, const char* name, const char* value) -> api::Xml {
    static_cast<FakeStream*>(node)->description += std::string(name) + "=" + value + ";";
    return node;
  };
  lsl.create_outlet = [](api::Info info, std::int32_t, std::int32_t) -> api::Outlet {
    if (fake_library.is_broken) return nullptr;
    static_cast<FakeStream*>(info)->is_offered = true;
    return info;
  };
  lsl.destroy_outlet = [](api::Outlet outlet) { static_cast<FakeStream*>(outlet)->is_offered = false; };
  lsl.have_consumers = [](api::Outlet) -> std::int32_t { return fake_library.has_consumers ? 1 : 0; };
  lsl.push_chunk_ftnp = [](api::Outlet outlet, const float* values, unsigned long count, const double* stamps_s, std::int32_t) {
    auto& stream = *static_cast<FakeStream*>(outlet);
    stream.values.insert(stream.values.end(), values, values + count);
    stream.stamps_s.insert(stream.stamps_s.end(), stamps_s, stamps_s + count / static_cast<unsigned long>(stream.channels));
    return std::int32_t{0};
  };
  lsl.push_sample_strtp = [](api::Outlet outlet, const char** texts, double stamp_s, std::int32_t) {
    auto& stream = *static_cast<FakeStream*>(outlet);
    stream.texts.emplace_back(texts[0]);
    stream.stamps_s.push_back(stamp_s);
    return std::int32_t{0};
  };
  return lsl;
}

class OutletsTest : public ::testing::Test {
 protected:
  OutletsTest() {
    fake_library = {};
    status_.set_version("0.1.0");
    status_.add_rigs()->mutable_rig()->set_name("floor");
    auto& device = *devices_.add_devices();
    device.set_rig("floor");
    device.set_model("USB-1608FS-Plus");
    device.set_serial("01AB");
    device.set_uri("mcc:1608fs-plus");
  }

  Outlets make(const Settings& settings = {}) {
    return Outlets(
        settings, functions_,
        [this]() -> client::Result<v1::GetDevicesResponse> {
          ++questions_;
          if (is_silent_) return tl::make_unexpected(client::Error{client::ErrorCode::Unreachable, "no answer", ""});
          return devices_;
        },
        clock_, core::Log());
  }
  /// Two scans of two channels.
  client::Block block(std::string_view stream = "raw") {
    topic_ = "floor/" + std::string(stream);
    format_.name = stream;
    client::Block made;
    made.topic = topic_;
    made.rig = std::string_view(topic_).substr(0, 5);
    made.stream = std::string_view(topic_).substr(6);
    made.format = &format_;
    made.rate = format_.rate;
    made.scan_count = 2;
    made.host_time_ns = 5'000'000'000;
    made.values = values_;
    made.quality = quality_;
    return made;
  }
  static v1::Event event_of(v1::Event event, std::int64_t host_ns) {
    event.set_host_time_ns(host_ns);
    return event;
  }
  static void give(Outlets& outlets, const v1::Event& event, std::string_view kind) {
    const std::string topic = "floor/" + std::string(kind);
    outlets.take(client::Event{.topic = topic, .rig = "floor", .kind = kind, .body = &event});
  }

  core::VirtualClock clock_{1'000'000'000};
  Liblsl functions_ = fake_functions();
  v1::StatusSnapshot status_;
  v1::GetDevicesResponse devices_;
  bool is_silent_ = false;
  int questions_ = 0;
  std::string topic_;
  client::StreamFormat format_{.name = "raw", .rate = {1500, 7}, .channels = {{"w1_v", "V"}, {"ml_mm", "mm"}}, .delay_ns = 5};
  std::vector<float> values_{1.0F, 2.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()};  // by channel
  std::vector<std::uint8_t> quality_{0, 0};
};

TEST_F(OutletsTest, Block_IsSentScanAfterScanWithExactTimes) {
  Outlets outlets = make();
  outlets.take(status_);
  client::Block second = block();
  outlets.take(second);
  second.first_scan = 1000;
  second.host_time_ns = 9'000'000'000;
  outlets.take(second);

  const FakeStream& raw = fake_library.of("floor/raw");
  EXPECT_EQ(raw.format, api::kFloat32);
  EXPECT_EQ(raw.channels, 2);
  EXPECT_DOUBLE_EQ(raw.rate_hz, 1500.0 / 7.0);
  ASSERT_EQ(raw.values.size(), 8U);
  EXPECT_EQ(raw.values[0], 1.0F);
  EXPECT_EQ(raw.values[1], -1.0F);
  EXPECT_EQ(raw.values[2], 2.0F);
  EXPECT_TRUE(std::isnan(raw.values[3]));
  EXPECT_THAT(raw.stamps_s, ElementsAre(5.0, 5.004666667, 9.0, 9.004666666));  // scan 1000 is at 4.666666667 s, and 1001 at 4.671333333 s
}

TEST_F(OutletsTest, Outlet_SaysWhatItsStreamIs) {
  Outlets outlets = make();
  outlets.take(status_);
  outlets.take(block());
  const FakeStream& raw = fake_library.of("floor/raw");
  EXPECT_EQ(raw.source_id, "dtsd/floor/raw/01AB");
  EXPECT_THAT(raw.description, HasSubstr("channels;channel;label=w1_v;unit=V;type=Voltage;channel;label=ml_mm;unit=mm;type=Position;"));
  EXPECT_THAT(raw.description, HasSubstr("model=USB-1608FS-Plus;serial_number=01AB;"));
  EXPECT_THAT(raw.description, HasSubstr("numerator=1500;denominator=7;delay_ns=5;"));
  const FakeStream& events = fake_library.of("floor/events");
  EXPECT_EQ(events.format, api::kString);
  EXPECT_EQ(events.rate_hz, api::kIrregularRate);
}

TEST_F(OutletsTest, DeviceWithoutSerialNumber_IsKnownByMachineAndAddress) {
  auto& device = *devices_.mutable_devices(0);
  device.clear_serial();
  Outlets outlets = make();
  outlets.take(block());
  EXPECT_THAT(fake_library.of("floor/raw").source_id, testing::MatchesRegex("dtsd/floor/raw/.+/mcc:1608fs-plus"));
  device.set_serial("sim-floor-7");  // that of every machine
  device.set_uri("sim:floor?seed=7");
  outlets.take(client::Restart{});
  outlets.take(block());
  EXPECT_THAT(fake_library.of("floor/raw").source_id, testing::MatchesRegex("dtsd/floor/raw/.+/sim:floor.seed=7"));
}

TEST_F(OutletsTest, CommandLineOfADevice_IsNotShown) {
  auto& device = *devices_.mutable_devices(0);
  device.clear_serial();
  device.set_uri("exec:/opt/daq --subject P017");
  Outlets outlets = make();
  outlets.take(status_);
  outlets.take(block());
  const std::string first = fake_library.of("floor/raw").source_id;
  EXPECT_THAT(first, testing::MatchesRegex("dtsd/floor/raw/.+/exec:[0-9a-f]{8}"));
  device.set_uri("exec:/opt/daq --subject P018");
  v1::Event change;
  change.mutable_device()->set_state(v1::DEVICE_STATE_STREAMING);
  change.mutable_device()->set_uri(device.uri());
  give(outlets, event_of(change, clock_.now_ns()), "device");
  EXPECT_THAT(fake_library.of("floor/events").texts, ElementsAre(Not(HasSubstr("/opt/daq"))));
  outlets.take(block());
  EXPECT_NE(fake_library.of("floor/raw").source_id, first);
}

TEST_F(OutletsTest, StreamsAndRigsThatAreNotWanted_AreNotOffered) {
  Settings settings;
  settings.streams = {"cop"};
  Outlets outlets = make(settings);
  outlets.take(block("raw"));
  outlets.take(block("cop"));
  EXPECT_THAT(fake_library.offered(), ElementsAre("floor/cop"));
  settings.rigs = {"chair"};
  Outlets other = make(settings);
  other.take(status_);
  other.take(block("cop"));
  v1::Event marker;
  marker.mutable_marker()->set_text("x");
  give(other, marker, "marker");
  EXPECT_EQ(other.count(), 0U);
  Outlets early = make();
  give(early, marker, "marker");
  EXPECT_EQ(early.count(), 0U) << "no status has named the daemon's version yet";
}

TEST_F(OutletsTest, WithoutConsumers_NothingIsSent) {
  fake_library.has_consumers = false;
  Outlets outlets = make();
  outlets.take(block());
  EXPECT_THAT(fake_library.of("floor/raw").values, IsEmpty());
}

TEST_F(OutletsTest, SilentDaemon_IsAskedOnceASecond) {
  is_silent_ = true;
  Outlets outlets = make();
  for (int turn = 0; turn < 5; ++turn) outlets.take(block());
  EXPECT_EQ(questions_, 1);
  is_silent_ = false;
  clock_.advance_ns(2 * core::kNanosecondsPerSecond);
  outlets.take(block());
  EXPECT_THAT(fake_library.offered(), ElementsAre("floor/raw"));
}

TEST_F(OutletsTest, BrokenLibrary_IsTriedAgainAfterASecond) {
  fake_library.is_broken = true;
  Outlets outlets = make();
  for (int turn = 0; turn < 5; ++turn) outlets.take(block());
  EXPECT_EQ(fake_library.streams.size(), 1U);
  fake_library.is_broken = false;
  clock_.advance_ns(2 * core::kNanosecondsPerSecond);
  outlets.take(block());
  EXPECT_THAT(fake_library.offered(), ElementsAre("floor/raw"));
}

TEST_F(OutletsTest, Restart_KeepsOutletsThatStillFit) {
  Outlets outlets = make();
  outlets.take(status_);
  outlets.take(block());
  const std::size_t made = fake_library.streams.size();
  outlets.take(client::Restart{.old_instance_id = 1, .new_instance_id = 2});
  EXPECT_THAT(fake_library.of("floor/events").texts, ElementsAre(HasSubstr("\"restart\"")));
  outlets.take(block());
  EXPECT_EQ(fake_library.streams.size(), made);
  EXPECT_EQ(questions_, 2) << "the device may be another one";

  outlets.take(client::Restart{.old_instance_id = 2, .new_instance_id = 3});
  format_.channels[1].unit = "N";
  outlets.take(block());
  EXPECT_EQ(fake_library.streams.size(), made + 1);
  EXPECT_THAT(fake_library.of("floor/raw").description, HasSubstr("unit=N;type=Force"));
}

TEST_F(OutletsTest, EveryFact_MakesAnotherOutlet) {
  const OutletFacts facts{
      .name = "floor/raw", .source_id = "s", .format = format_, .device_model = "m", .device_serial = "n", .daemon_version = "1"};
  const std::vector<std::function<void(OutletFacts&)>> changes{
      [](OutletFacts& other) { other.name += "x"; },
      [](OutletFacts& other) { other.source_id += "x"; },
      [](OutletFacts& other) { other.device_model += "x"; },
      [](OutletFacts& other) { other.device_serial += "x"; },
      [](OutletFacts& other) { other.daemon_version += "x"; },
      [](OutletFacts& other) { other.format.reset(); },
      [](OutletFacts& other) { other.format->name = "cop"; },
      [](OutletFacts& other) { ++other.format->rate.numerator; },
      [](OutletFacts& other) { ++other.format->delay_ns; },
      [](OutletFacts& other) { other.format->channels.pop_back(); },
      [](OutletFacts& other) { other.format->channels[0].name = "x"; },
      [](OutletFacts& other) { other.format->channels[1].unit = "N"; },
  };
  EXPECT_TRUE(facts == OutletFacts(facts));
  for (std::size_t index = 0; index < changes.size(); ++index) {
    OutletFacts other = facts;
    changes[index](other);
    EXPECT_FALSE(facts == other) << "change " << index;
  }
}

TEST_F(OutletsTest, OtherDeviceAtTheSameRig_IsAnotherSource) {
  Outlets outlets = make();
  outlets.take(block());
  devices_.mutable_devices(0)->set_serial("02CD");
  v1::Event change;
  change.mutable_device()->set_state(v1::DEVICE_STATE_STREAMING);
  give(outlets, event_of(change, clock_.now_ns()), "device");
  outlets.take(block());
  EXPECT_EQ(fake_library.of("floor/raw").source_id, "dtsd/floor/raw/02CD");
}

TEST_F(OutletsTest, LossOnTheWay_IsAnEvent) {
  Outlets outlets = make();
  outlets.take(status_);
  client::Block late = block();
  late.segment = 3;
  late.first_scan = 70;
  late.lost_scans = 20;
  outlets.take(late);
  const FakeStream& events = fake_library.of("floor/events");
  ASSERT_EQ(events.texts.size(), 1U);
  EXPECT_EQ(json::parse(events.texts[0]), json::parse(R"({"segment": 3, "scan": "70", "host_time_ns": "5000000000",
    "loss": {"scans": "20"}, "stream": "raw", "is_exact": true})"));
  EXPECT_THAT(events.stamps_s, ElementsAre(5.0));
}

TEST_F(OutletsTest, Events_AreSentAtTheirTimeWithoutThePerson) {
  Outlets outlets = make();
  outlets.take(status_);
  v1::Event session;
  session.set_instance_id(7);
  session.mutable_session()->set_session_id("s1");
  session.mutable_session()->set_subject("P017");
  session.mutable_session()->set_label("eyes closed");
  session.mutable_session()->set_state(v1::SESSION_STATE_RUNNING);
  give(outlets, event_of(session, 1'500'000'000), "session");
  const FakeStream& events = fake_library.of("floor/events");
  ASSERT_EQ(events.texts.size(), 1U);
  EXPECT_THAT(events.stamps_s, ElementsAre(1.5));
  EXPECT_THAT(events.texts[0], Not(HasSubstr("P017")));
  EXPECT_THAT(events.texts[0], Not(HasSubstr("eyes")));
  EXPECT_THAT(events.texts[0], Not(HasSubstr("instance_id")));
  EXPECT_EQ(json::parse(events.texts[0]).at("session").at("session_id"), "s1");
}

TEST_F(OutletsTest, StatesFromBeforeTheStart_AndRunningMeasures_AreNotSent) {
  Outlets outlets = make();
  outlets.take(status_);
  v1::Event old;
  old.mutable_session()->set_state(v1::SESSION_STATE_IDLE);
  give(outlets, event_of(old, 999'999'999), "session");
  v1::Event running;
  running.mutable_sway()->set_is_preliminary(true);
  give(outlets, event_of(running, 2'000'000'000), "sway");
  EXPECT_THAT(fake_library.of("floor/events").texts, IsEmpty());
  v1::Event marker;
  marker.mutable_marker()->set_text("x");
  give(outlets, event_of(marker, 999'999'999), "marker");
  running.mutable_sway()->set_is_preliminary(false);
  give(outlets, event_of(running, 2'000'000'000), "sway");
  EXPECT_EQ(fake_library.of("floor/events").texts.size(), 2U);
}

}  // namespace
}  // namespace dts::lsl
