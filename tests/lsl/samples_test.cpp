// SPDX-License-Identifier: Apache-2.0
// dtsd, dts-lsl and a genuine inlet of liblsl: every sample and every time stamp as dtsd has published it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <unordered_map>

#include "lsl/lsl_peer.h"
#include "lsl/lsl_system.h"
#include "lsl/outlet.h"

namespace dts::test {
namespace {

using std::chrono::steady_clock;
using testing::HasSubstr;

const std::vector<std::string> kStreams{"raw", "filtered", "deflection", "cop", "aux"};

/// Seconds of the long comparison: 10 in the suite, DTS_LSL_SECONDS elsewhere.
double wanted_s() {
  const char* const text = std::getenv("DTS_LSL_SECONDS");
  return text != nullptr ? std::atof(text) : 10.0;
}

/// What dtsd has published of one stream.
struct Published {
  std::vector<std::int64_t> times_ns;
  std::vector<float> values;  // scan after scan
  std::uint64_t lost = 0;
};

/// Follows dtsd on a thread of its own.
class Reference {
 public:
  explicit Reference(const DaemonProcess& daemon) {
    std::vector<std::string> topics;
    for (const std::string& stream : kStreams) topics.push_back("floor/" + stream);
    thread_ =
        std::jthread([this, subscriber = std::make_shared<client::Subscriber>(daemon.subscribe(topics))](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            const auto message = subscriber->receive(std::chrono::milliseconds(100));
            if (!message || !*message) continue;
            if (const auto* block = std::get_if<client::Block>(&**message)) take(*block);
          }
        });
  }
  void stop() {
    thread_.request_stop();
    thread_.join();
  }
  [[nodiscard]] const Published& of(const std::string& stream) const { return published_.at(stream); }

 private:
  void take(const client::Block& block) {
    Published& published = published_[std::string(block.stream)];
    if (!published.times_ns.empty()) published.lost += block.lost_scans;
    for (std::size_t scan = 0; scan < block.scan_count; ++scan) {
      // As documented: the time of the first scan and the exact rate, in integers and without the code of dts-lsl.
      const auto offset_ns = static_cast<std::int64_t>(scan) * 1'000'000'000 * block.rate.denominator / block.rate.numerator;
      published.times_ns.push_back(block.host_time_ns + offset_ns);
      for (std::size_t channel = 0; channel < block.channel_count(); ++channel) published.values.push_back(block.column(channel)[scan]);
    }
  }

  std::map<std::string, Published> published_;
  std::jthread thread_;
};

struct Comparison {
  std::size_t identical = 0;
  std::size_t unknown = 0;  // samples of the inlet that the test's own subscriber has not received
  std::size_t missing = 0;  // scans of dtsd that the inlet has not received, between its first and its last
};

/// Compares what an inlet has received with what dtsd has published at the same times. A time may differ by 1 ns, by rounding.
Comparison compare(const std::string& stream, const Inlet::Samples& received, std::size_t channels, const Published& published) {
  std::unordered_map<std::int64_t, std::size_t> scan_at;
  for (std::size_t scan = 0; scan < published.times_ns.size(); ++scan) scan_at.emplace(published.times_ns[scan], scan);
  const auto find = [&scan_at](std::int64_t time_ns) {
    for (const std::int64_t rounding_ns : {0, -1, 1}) {
      if (const auto found = scan_at.find(time_ns + rounding_ns); found != scan_at.end()) return found;
    }
    return scan_at.end();
  };
  Comparison comparison;
  std::size_t next = published.times_ns.size();
  for (std::size_t sample = 0; sample < received.stamps_s.size(); ++sample) {
    const auto found = find(std::llround(received.stamps_s[sample] * 1e9));
    if (found == scan_at.end()) {
      ++comparison.unknown;
      continue;
    }
    const std::size_t scan = found->second;
    if (std::memcmp(&received.values[sample * channels], &published.values[scan * channels], channels * sizeof(float)) != 0) {
      ADD_FAILURE() << stream << ": sample " << sample << " has other values than scan " << scan << " of dtsd";
      return comparison;
    }
    if (next < scan) comparison.missing += scan - next;
    next = scan + 1;
    ++comparison.identical;
  }
  return comparison;
}

class LslSamples : public ::testing::Test {
 protected:
  void SetUp() override {
    if (liblsl_file().empty()) GTEST_SKIP() << "no liblsl: it comes with npm on x86-64, or with -DDTS_LIBLSL=FILE";
    isolate_lsl();
  }
};

TEST_F(LslSamples, ClockOfLsl_IsMonotonic) {
  for (int turn = 0; turn < 100; ++turn) {
    const std::int64_t before_ns = monotonic_ns();
    const double lsl_s = liblsl().local_clock();
    const std::int64_t after_ns = monotonic_ns();
    EXPECT_GE(std::llround(lsl_s * 1e9), before_ns - 1);
    EXPECT_LE(std::llround(lsl_s * 1e9), after_ns + 1);
  }
}

TEST_F(LslSamples, EverySample_IsThatOfDtsd) {
  RecordProperty("requirement", "PUB-10");
  DaemonProcess daemon({.device = "sim:floor?seed=7&extra=12", .acquire = "rate_hz = 1500.0"});
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  const LslProcess bridge(daemon);
  ASSERT_TRUE(bridge.is_ready()) << bridge.log();
  std::map<std::string, std::unique_ptr<Inlet>> inlets;
  std::map<std::string, Inlet::Samples> received;
  Reference reference(daemon);
  ASSERT_TRUE(eventually([&daemon] { return daemon.control().status()->rigs(0).scans_total() > 1500; }));
  for (const std::string& stream : kStreams) inlets[stream] = std::make_unique<Inlet>("floor/" + stream);
  Inlet events("floor/events");
  ASSERT_TRUE(is_connected(daemon, events)) << bridge.log();

  const auto wanted = static_cast<std::size_t>(wanted_s() * 1500.0);
  const auto deadline = steady_clock::now() + std::chrono::seconds(static_cast<int>(wanted_s())) + kPatience;
  const auto has_all = [&] {
    return std::ranges::all_of(kStreams, [&](const std::string& stream) { return received[stream].stamps_s.size() >= wanted; });
  };
  while (!has_all() && steady_clock::now() < deadline) {
    std::size_t pulled = 0;
    for (const std::string& stream : kStreams) pulled += inlets[stream]->pull(received[stream], 0.0);
    if (pulled == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_TRUE(has_all()) << bridge.log();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // so that the reference has all that the inlets have
  reference.stop();

  std::map<std::string, std::size_t> reported;  // scans that dts-lsl has lost on a machine that is too slow
  while (const auto event = events.pull_text(0.0)) {
    const auto parsed = nlohmann::json::parse(event->text);
    if (parsed.contains("loss")) reported[parsed.at("stream")] += std::stoull(parsed.at("loss").at("scans").get<std::string>());
  }
  std::size_t channels = 0;
  for (const std::string& stream : kStreams) {
    const Published& published = reference.of(stream);
    const Comparison compared = compare(stream, received[stream], inlets[stream]->channels(), published);
    std::printf("floor/%s: %zu of %zu samples of %zu channels identical, values and time stamps; lost and reported: %zu\n", stream.c_str(),
                compared.identical, received[stream].stamps_s.size(), inlets[stream]->channels(), reported[stream]);
    EXPECT_LE(compared.unknown, published.lost) << stream << ": samples that dtsd has not published";
    EXPECT_LE(compared.missing, reported[stream]) << stream << ": a loss that no event reports";
    EXPECT_GE(compared.identical + published.lost, wanted) << stream;
    channels += stream == "raw" || stream == "aux" ? inlets[stream]->channels() : 0;
  }
  EXPECT_GE(channels, 16U);
}

TEST_F(LslSamples, Outlets_DescribeTheirStreamsAndOutliveRestarts) {
  DaemonProcess daemon;
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  LslProcess bridge(daemon, "streams = [\"raw\", \"cop\"]");
  ASSERT_TRUE(bridge.is_ready()) << bridge.log();

  Inlet raw("floor/raw");
  EXPECT_EQ(raw.channels(), 4U);
  EXPECT_THAT(raw.xml(), HasSubstr("<type>DTS</type>"));
  EXPECT_THAT(raw.xml(), HasSubstr("<channel_format>float32</channel_format>"));
  EXPECT_THAT(raw.xml(), HasSubstr("<nominal_srate>100"));
  EXPECT_THAT(raw.xml(), HasSubstr("<label>w1_v</label><unit>V</unit><type>Voltage</type>")) << raw.xml();
  EXPECT_THAT(raw.xml(), HasSubstr("<can_drop_samples>true</can_drop_samples>"));
  EXPECT_THAT(Inlet("floor/cop").xml(), HasSubstr("<label>ml_mm</label><unit>mm</unit><type>Position</type>"));
  EXPECT_THAT(Inlet("floor/events").xml(), HasSubstr("<type>Markers</type>"));
  EXPECT_THAT(bridge.log(), testing::Not(HasSubstr("floor/deflection")));

  // The same inlet goes on after a restart of dts-lsl (found by the source_id) and after one of dtsd (the outlet stays).
  Inlet::Samples samples;
  const auto goes_on = [&](std::size_t more) {
    const std::size_t before = samples.stamps_s.size();
    return eventually([&] { return raw.pull(samples, 0.1) > 0 && samples.stamps_s.size() > before + more; });
  };
  ASSERT_TRUE(goes_on(10));
  EXPECT_EQ(bridge.end(SIGTERM), 0);
  bridge.start();
  ASSERT_TRUE(goes_on(10));
  Inlet events("floor/events");
  ASSERT_TRUE(is_connected(daemon, events)) << bridge.log();
  daemon.signal(SIGKILL);
  static_cast<void>(daemon.wait());
  daemon.restart();
  const double restarted_s = lsl::lsl_time_s(monotonic_ns());
  ASSERT_TRUE(eventually([&] { return raw.pull(samples, 0.1) > 0 && samples.stamps_s.back() > restarted_s; }));
  ASSERT_TRUE(eventually([&] {
    const auto event = events.pull_text(0.1);
    return event && event->text.find("\"restart\"") != std::string::npos;
  }));
  EXPECT_TRUE(bridge.is_running());
}

}  // namespace
}  // namespace dts::test
