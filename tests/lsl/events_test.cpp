// SPDX-License-Identifier: Apache-2.0
// Events of dtsd in LSL, markers of LSL in dtsd, and a LabRecorder that records one file for each session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "lsl/lsl_peer.h"
#include "lsl/lsl_system.h"
#include "lsl/outlet.h"
#include "support/fake_lab_recorder.h"

namespace dts::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class LslEvents : public ::testing::Test {
 protected:
  void SetUp() override {
    if (liblsl_file().empty()) GTEST_SKIP() << "no liblsl: it comes with npm on x86-64, or with -DDTS_LIBLSL=FILE";
    isolate_lsl();
  }
};

/// Returns the next event in LSL that has `key`.
std::optional<std::pair<json, double>> next_event(Inlet& events, const std::string& key) {
  std::optional<std::pair<json, double>> found;
  static_cast<void>(eventually([&] {
    const auto text = events.pull_text(0.1);
    if (!text) return false;
    json event = json::parse(text->text);
    if (event.contains(key)) found.emplace(std::move(event), text->stamp_s);
    return found.has_value();
  }));
  return found;
}

std::string start_session(const DaemonProcess& daemon) {
  v1::StartSessionRequest request;
  request.set_rig("floor");
  request.set_protocol("free");
  request.set_subject("P017");
  request.set_label("eyes closed");
  const auto started = daemon.control().start_session(request);
  EXPECT_TRUE(started) << started.error().what;
  return started ? started->session_id() : "";
}

bool has_scans(const DaemonProcess& daemon) {
  return eventually([&daemon] { return daemon.control().status()->rigs(0).scans_total() > 50; });
}

TEST_F(LslEvents, EventsOfDtsd_AreMarkersInLsl) {
  DaemonProcess daemon;
  ASSERT_TRUE(daemon.is_ready() && has_scans(daemon)) << daemon.log();
  const LslProcess bridge(daemon);
  ASSERT_TRUE(bridge.is_ready()) << bridge.log();
  Inlet events("floor/events");
  ASSERT_TRUE(is_connected(daemon, events)) << bridge.log();
  auto own = daemon.subscribe({"floor/marker"});

  ASSERT_TRUE(daemon.control().mark("heel strike", "floor"));
  const auto marked = next_event(events, "marker");
  ASSERT_TRUE(marked);
  EXPECT_EQ(marked->first.at("marker").at("text"), "heel strike");
  std::int64_t published_ns = 0;
  ASSERT_TRUE(eventually([&] {
    const auto message = own.receive(std::chrono::milliseconds(100));
    const auto* event = message && *message ? std::get_if<client::Event>(&**message) : nullptr;
    if (event != nullptr) published_ns = event->body->host_time_ns();
    return event != nullptr;
  }));
  EXPECT_LE(std::abs(std::llround(marked->second * 1e9) - published_ns), 1);

  const std::string id = start_session(daemon);
  const auto session = next_event(events, "session");
  ASSERT_TRUE(session);
  EXPECT_EQ(session->first.at("session").at("session_id"), id);
  EXPECT_THAT(session->first.dump(), AllOf(Not(HasSubstr("P017")), Not(HasSubstr("eyes closed"))));
  ASSERT_TRUE(daemon.control().stop_session("floor"));
}

TEST_F(LslEvents, Gap_IsAnEventAndAJumpOfTheTimeStamps) {
  RecordProperty("requirement", "PUB-10");
  DaemonProcess daemon;
  ASSERT_TRUE(daemon.is_ready() && has_scans(daemon)) << daemon.log();
  const LslProcess bridge(daemon);
  ASSERT_TRUE(bridge.is_ready()) << bridge.log();
  Inlet events("floor/events");
  ASSERT_TRUE(is_connected(daemon, events)) << bridge.log();
  Inlet raw("floor/raw");
  Inlet::Samples samples;
  ASSERT_TRUE(eventually([&] { return raw.pull(samples, 0.1) > 0; }));
  daemon.signal(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(6));  // longer than any queue
  daemon.signal(SIGCONT);

  const auto gap = next_event(events, "gap");
  ASSERT_TRUE(gap) << bridge.log();
  const double missing = std::stod(gap->first.at("gap").at("missing_scans").get<std::string>());
  EXPECT_GT(missing, 0.0);
  ASSERT_TRUE(eventually([&] { return raw.pull(samples, 0.1) > 0 && samples.stamps_s.back() > gap->second; }));
  double largest_s = 0.0;
  for (std::size_t scan = 1; scan < samples.stamps_s.size(); ++scan) {
    largest_s = std::max(largest_s, samples.stamps_s[scan] - samples.stamps_s[scan - 1]);
  }
  EXPECT_NEAR(largest_s, (missing + 1.0) / 100.0, 0.1) << "as long as the scans that are missing";
}

TEST_F(LslEvents, MarkersOfLsl_AreMarkersOfDtsdAtTheirTime) {
  RecordProperty("requirement", "PUB-10");
  DaemonProcess daemon;
  ASSERT_TRUE(daemon.is_ready() && has_scans(daemon)) << daemon.log();
  auto own = daemon.subscribe({"floor/marker"});
  // A regular stream and an outlet of dts-lsl match, too, and are skipped.
  PeerOutlet markers("Task", 0, 0.0, "task-1");
  PeerOutlet regular("Task", 1, 10.0, "task-2");
  const LslProcess bridge(daemon, "markers_from = [\"name='Task'\", \"starts-with(source_id,'dtsd/')\"]");
  ASSERT_TRUE(bridge.is_ready()) << bridge.log();
  ASSERT_TRUE(eventually([&] { return markers.has_consumers(); })) << bridge.log();
  EXPECT_TRUE(eventually([&] { return bridge.log().find("it is skipped") != std::string::npos; }));

  const std::string id = start_session(daemon);
  ASSERT_TRUE(eventually([&] { return daemon.control().status()->rigs(0).session().elapsed_s() > 1.0; }));  // the markers are in it
  const std::int64_t sent_ns = monotonic_ns() - 300'000'000;  // markers may arrive late
  const double sent_s = lsl::lsl_time_s(sent_ns);
  markers.push("stimulus", sent_s);
  markers.push("stimulus", sent_s);  // another one: those of one chunk have one time
  markers.push("Anna Schmidt, born 1950", lsl::lsl_time_s(monotonic_ns()));
  markers.push("response", lsl::lsl_time_s(monotonic_ns()));

  std::vector<std::pair<std::string, std::int64_t>> found;
  ASSERT_TRUE(eventually([&] {
    const auto message = own.receive(std::chrono::milliseconds(100));
    const auto* event = message && *message ? std::get_if<client::Event>(&**message) : nullptr;
    if (event != nullptr) found.emplace_back(event->body->marker().text(), event->body->host_time_ns());
    return !found.empty() && found.back().first == "response";
  })) << bridge.log();
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t index = 0; index < 2; ++index) {
    EXPECT_EQ(found[index].first, "stimulus");
    EXPECT_LE(std::abs(found[index].second - sent_ns), 1);
  }
  EXPECT_TRUE(eventually([&] { return bridge.log().find("is not in the session") != std::string::npos; }));
  EXPECT_THAT(bridge.log(), Not(HasSubstr("Schmidt")));

  ASSERT_TRUE(daemon.control().stop_session("floor"));
  const auto shown = daemon.control().show_session(id);
  ASSERT_TRUE(shown);
  ASSERT_EQ(shown->markers_size(), 3);
  EXPECT_EQ(shown->markers(0).text(), "stimulus");
  EXPECT_EQ(daemon.ctl({"session", "verify", id}).status, 0);
}

TEST_F(LslEvents, LabRecorder_RecordsOneFileForEachSession) {
  DaemonProcess daemon;
  ASSERT_TRUE(daemon.is_ready() && has_scans(daemon)) << daemon.log();
  FakeLabRecorder recorder;
  LslProcess bridge(daemon, "", "[labrecorder]\naddress = \"127.0.0.1:" + std::to_string(recorder.port()) + "\"\nfolder = \"/data\"\n");
  ASSERT_TRUE(bridge.is_ready()) << bridge.log();

  std::vector<std::string> expected;
  for (int session = 0; session < 2; ++session) {
    const std::string id = start_session(daemon);
    expected.insert(expected.end(), {"update", "filename {root:/data} {template:dtsd_" + id + ".xdf}", "start"});
    ASSERT_TRUE(eventually([&] { return recorder.lines().size() >= expected.size(); })) << bridge.log();
    EXPECT_EQ(recorder.lines(), expected);
    if (session == 1) break;
    ASSERT_TRUE(daemon.control().stop_session("floor"));
    expected.emplace_back("stop");
    ASSERT_TRUE(eventually([&] { return recorder.lines().size() >= expected.size(); })) << bridge.log();
  }
  EXPECT_EQ(bridge.end(SIGTERM), 0);  // the file of the second session is not left open
  expected.emplace_back("stop");
  EXPECT_EQ(recorder.lines(), expected);
}

}  // namespace
}  // namespace dts::test
