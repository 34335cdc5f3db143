// SPDX-License-Identifier: Apache-2.0
// The page for a monitor, with the real daemon behind it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gateway/gateway_process.h"
#include "gateway/raw_client.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string get(const GatewayProcess& gateway, const std::string& path, const std::string& headers = {}) {
  RawClient client(gateway.port());
  client.send(request(gateway.port(), "GET " + path, headers));
  return client.read_answer();
}

/// The value of the series of that name and labels; nothing when it is not there.
std::optional<double> value_of(const std::string& page, const std::string& series) {
  const std::size_t at = page.find("\n" + series + " ");
  if (at == std::string::npos) return std::nullopt;
  return std::stod(page.substr(at + series.size() + 2));
}

bool has_more_than(const std::string& page, const std::string& series, double bound) {
  return value_of(page, series).value_or(-1.0) > bound;
}

TEST(GatewayMetrics, SayWhatTheDaemonDoes) {
  RecordProperty("requirement", "CFG-7");
  const DaemonProcess daemon;
  const GatewayProcess gateway(daemon, {});
  ASSERT_NE(gateway.port(), 0) << gateway.log();
  ASSERT_EQ(daemon.ctl({"session", "start", "--rig", "floor", "--protocol", "free"}).status, 0);
  std::string page;

  const bool has_all = eventually([&] {
    page = get(gateway, "/metrics");
    return has_more_than(page, R"(dts_scans_total{rig="floor"})", 100.0) &&
           has_more_than(page, R"(dts_measured_rate_hertz{rig="floor"})", 50.0) &&
           has_more_than(page, R"(dts_recording_bytes{rig="floor"})", 0.0);
  });

  ASSERT_TRUE(has_all) << page;
  EXPECT_THAT(page, HasSubstr("Content-Type: text/plain; version=0.0.4"));
  EXPECT_EQ(value_of(page, "dts_up"), 1.0);
  EXPECT_EQ(value_of(page, R"(dts_device_state{rig="floor",state="streaming"})"), 1.0);
  EXPECT_EQ(value_of(page, R"(dts_recording_active{rig="floor"})"), 1.0);
  EXPECT_TRUE(has_more_than(page, R"(dts_recording_lag_seconds{rig="floor"})", 0.0)) << "synchronised twice a second, never at once";
  EXPECT_TRUE(has_more_than(page, R"(dts_block_latency_seconds_bucket{rig="floor",le="+Inf"})", 10.0));
  EXPECT_TRUE(has_more_than(page, R"(dts_block_latency_seconds_sum{rig="floor"})", 0.0));
  EXPECT_TRUE(has_more_than(page, R"(dts_ring_fill_ratio{rig="floor",ring="frames"})", 0.0));
  EXPECT_TRUE(has_more_than(page, R"(dts_gateway_answers_total{status="200"})", 0.0));
}

TEST(GatewayMetrics, OfADaemonThatIsGone_VanishAndSayIt) {
  DaemonProcess daemon;
  const GatewayProcess gateway(daemon, {});
  ASSERT_NE(gateway.port(), 0) << gateway.log();
  ASSERT_TRUE(eventually([&] { return value_of(get(gateway, "/metrics"), "dts_up") == 1.0; }));

  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);

  EXPECT_TRUE(eventually([&] { return value_of(get(gateway, "/metrics"), "dts_up") == 0.0; }));
  EXPECT_THAT(get(gateway, "/metrics"), Not(HasSubstr("rig=")));
}

TEST(GatewayMetrics, SwitchedOff_AreNotThere) {
  const DaemonProcess daemon;
  const GatewayProcess gateway(daemon, {"--metrics", "false"});
  ASSERT_NE(gateway.port(), 0) << gateway.log();

  EXPECT_EQ(status_of(get(gateway, "/metrics")), "404");
}

}  // namespace
}  // namespace dts::test
