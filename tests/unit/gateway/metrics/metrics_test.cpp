// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "unit/gateway/metrics/metrics_fixture.h"

namespace dts::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The lines that are no comments.
std::vector<std::string> samples_of(const std::string& text) {
  std::vector<std::string> samples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) samples.push_back(line);
  }
  return samples;
}

TEST(Metrics, OfASilentDaemon_AreTheGatewaysOwn) {
  EXPECT_EQ(samples_of(metrics_text(nullptr, some_counts())),
            (std::vector<std::string>{"dts_up 0", "dts_gateway_info{version=\"1.2.3\"} 1", "dts_gateway_connections 4",
                                      "dts_gateway_tabs 3", "dts_gateway_connections_total 20", "dts_gateway_refused_connections_total 1",
                                      "dts_gateway_refused_requests_total 2", "dts_gateway_answers_total{status=\"200\"} 15",
                                      "dts_gateway_answers_total{status=\"404\"} 3", "dts_gateway_refused_logins_total 5",
                                      "dts_gateway_dropped_blocks_total 8", "dts_gateway_dropped_scans_total 800",
                                      "dts_gateway_dropped_events_total 9"}));
}

TEST(Metrics, OfADaemon_SayEveryFigureInBaseUnits) {
  const std::vector<std::string> samples = samples_of(metrics_text(carried(eventful_status()), {}));

  const std::vector<std::string> expected{"dts_up 1",
                                          R"(dts_daemon_info{version="0.1.0"} 1)",
                                          "dts_daemon_uptime_seconds 12.5",
                                          "dts_daemon_notices 1",
                                          "dts_rejected_requests_total 2",
                                          R"(dts_disk_state{state="fine"} 0)",
                                          R"(dts_disk_state{state="low"} 1)",
                                          R"(dts_disk_state{state="full"} 0)",
                                          R"(dts_disk_state{state="unusable"} 0)",
                                          "dts_disk_free_bytes 5000000000",
                                          "dts_disk_recordable_seconds 1800.5",
                                          R"(dts_device_state{rig="floor",state="closed"} 0)",
                                          R"(dts_device_state{rig="floor",state="open"} 0)",
                                          R"(dts_device_state{rig="floor",state="streaming"} 1)",
                                          R"(dts_device_state{rig="floor",state="gone"} 0)",
                                          R"(dts_device_state{rig="floor",state="waiting"} 0)",
                                          R"(dts_scans_total{rig="floor"} 123456789)",
                                          R"(dts_reconnects_total{rig="floor"} 1)",
                                          R"(dts_device_restarts_total{rig="floor"} 4)",
                                          R"(dts_nominal_rate_hertz{rig="floor"} 100)",
                                          R"(dts_measured_rate_hertz{rig="floor"} 100.02)",
                                          R"(dts_clock_drift_ratio{rig="floor"} -2.5e-05)",
                                          R"(dts_host_time_uncertainty_seconds{rig="floor"} 0.0015)",
                                          R"(dts_lost_scans_total{rig="floor",cause="overrun"} 0)",
                                          R"(dts_lost_scans_total{rig="floor",cause="unplugged"} 0)",
                                          R"(dts_lost_scans_total{rig="floor",cause="silence"} 0)",
                                          R"(dts_lost_scans_total{rig="floor",cause="ring_full"} 150)",
                                          R"(dts_lost_scans_total{rig="floor",cause="integrity"} 0)",
                                          R"(dts_lost_scans_total{rig="floor",cause="stall"} 0)",
                                          R"(dts_gaps_total{rig="floor",cause="overrun"} 0)",
                                          R"(dts_gaps_total{rig="floor",cause="unplugged"} 0)",
                                          R"(dts_gaps_total{rig="floor",cause="silence"} 0)",
                                          R"(dts_gaps_total{rig="floor",cause="ring_full"} 2)",
                                          R"(dts_gaps_total{rig="floor",cause="integrity"} 0)",
                                          R"(dts_gaps_total{rig="floor",cause="stall"} 0)",
                                          R"(dts_pipeline_seconds_per_scan{rig="floor"} 1.25e-05)",
                                          R"(dts_ring_fill_ratio{rig="floor",ring="frames"} 0.25)",
                                          R"(dts_ring_fill_ratio{rig="floor",ring="record"} 0.015)",
                                          R"(dts_dropped_blocks_total{rig="floor"} 5)",
                                          R"(dts_lost_events_total{rig="floor"} 6)",
                                          R"(dts_block_latency_seconds_count{rig="floor"} 100)",
                                          R"(dts_block_latency_seconds_sum{rig="floor"} 0.75)",
                                          R"(dts_block_latency_seconds_bucket{rig="floor",le="0.0001"} 0)",
                                          R"(dts_block_latency_seconds_bucket{rig="floor",le="0.005"} 90)",
                                          R"(dts_block_latency_seconds_bucket{rig="floor",le="+Inf"} 100)",
                                          R"(dts_session_state{rig="floor",state="idle"} 0)",
                                          R"(dts_session_state{rig="floor",state="starting"} 0)",
                                          R"(dts_session_state{rig="floor",state="settling"} 0)",
                                          R"(dts_session_state{rig="floor",state="running"} 1)",
                                          R"(dts_session_state{rig="floor",state="stopping"} 0)",
                                          R"(dts_session_state{rig="floor",state="failed"} 0)",
                                          R"(dts_recording_active{rig="floor"} 1)",
                                          R"(dts_recording_bytes{rig="floor"} 4096)",
                                          R"(dts_recording_lost_scans{rig="floor"} 7)",
                                          R"(dts_recording_lag_seconds{rig="floor"} 0.5)"};
  std::vector<std::string> of_daemon;
  std::ranges::copy_if(samples, std::back_inserter(of_daemon), [](const std::string& line) { return !line.starts_with("dts_gateway_"); });
  EXPECT_EQ(of_daemon, expected);
}

TEST(Metrics, NameNobody) {
  const std::string text = metrics_text(carried(eventful_status()), some_counts());

  for (const char* private_word : {"P007", "after lunch", "20260131", "/var/lib", "SCHED_FIFO"}) {
    EXPECT_THAT(text, Not(HasSubstr(private_word)));
  }
}

TEST(Metrics, EveryFamily_IsToldOnceWithTypeAndHelp) {
  v1::StatusSnapshot status = eventful_status();
  *status.add_rigs() = status.rigs(0);
  status.mutable_rigs(1)->mutable_rig()->set_name("chair");
  const std::string text = metrics_text(carried(status), some_counts());
  std::set<std::string> typed;
  std::istringstream lines(text);

  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string mark, keyword, name, type;
    words >> mark >> keyword >> name >> type;
    if (keyword != "TYPE") continue;
    EXPECT_TRUE(typed.insert(name).second) << name << " is told twice: Prometheus refuses the whole page";
    EXPECT_EQ(name.ends_with("_total"), type == "counter") << name;
    EXPECT_THAT(text, HasSubstr("# HELP " + name + " "));
  }
  EXPECT_GT(typed.size(), 30U);
  EXPECT_THAT(text, HasSubstr(R"(dts_scans_total{rig="chair"} 123456789)"));
}

TEST(Metrics, WhatStandsInALabel_CannotEndIt) {
  v1::StatusSnapshot status = eventful_status();
  status.set_version("1\"} 7\ndts_up 9 \\");

  const std::string text = metrics_text(carried(status), {});

  EXPECT_THAT(text, HasSubstr(R"(dts_daemon_info{version="1\"} 7\ndts_up 9 \\"} 1)"));
  EXPECT_THAT(text, Not(HasSubstr("\ndts_up 9")));
}

TEST(Metrics, BytesThatAreNoStatus_AreASilentDaemon) {
  const auto broken = std::make_shared<Carried>(Carried{.topic = std::string(kStatusTopic), .bytes = "\xff\xff\xff"});

  EXPECT_EQ(samples_of(metrics_text(broken, {})).front(), "dts_up 0");
}

}  // namespace
}  // namespace dts::gateway
