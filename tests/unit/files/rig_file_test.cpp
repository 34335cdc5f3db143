// SPDX-License-Identifier: Apache-2.0
// Every key of a rig's file but those that name other files.
#include "files/rig_file.h"

#include <gmock/gmock.h>

#include <array>
#include <sstream>
#include <tuple>

#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

using testing::ElementsAre;

std::string sensor(const std::string& label, const std::string& x_mm, const std::string& y_mm, const std::string& more = "") {
  return "[[sensor]]\nlabel = \"" + label + "\"\nx_mm = " + x_mm + "\ny_mm = " + y_mm +
         "\ncurve = { name = \"c\", point = [{ gap_mm = 4, volts = 4 }, { gap_mm = 13, volts = 1 }] }\n" + more;
}
std::string stage(const std::string& id) { return "[[stage]]\nid = \"" + id + "\"\n"; }

const std::string kTop = R"(kind = "floor"
transient_sensors = ["w1", "w2", "w3", "w4"]
[plate]
a_mm = 430.0
b_mm = 400.0
h_mm = 3.0
e_pa = 2e11
nu = 0.3
[support]
kind = "edges"
inset_mm = 10.75
[acquire]
rate_hz = 200.0
block_ms = 50.0
low_latency = false
[trigger]
channel = 6
level = 1.5
hysteresis = 0.25
edges = "both"
[session]
sync_pulse_ms = 80.0
[publish]
streams = ["raw"]
[record]
streams = ["raw", "cop"]
)";
const std::string kRig = kTop + sensor("w1", "86", "87", "channel = 30\nunloaded_gap_mm = 11.5\n") + sensor("w2", "344", "88") +
                         sensor("w3", "85", "343") + sensor("w4", "343", "344") + stage("guard") + stage("window_filter") +
                         "window_scans = 5\n" + stage("linearise") + stage("cop") + "estimator = \"thesis\"\n";

class RigFile : public FilesTest {
 protected:
  static pipeline::RigConfig read(const std::string& text, Problems& problems) { return read_rig_text(text, "rig", problems); }
};

TEST_F(RigFile, EveryKey_ReachesItsField) {
  Problems problems;
  const auto rig = read(kRig, problems);

  ASSERT_EQ(text_of(problems), "");
  EXPECT_EQ(rig.kind, "floor");
  ASSERT_TRUE(rig.model.transient_sensors);
  EXPECT_THAT(rig.model.transient_sensors->rear, ElementsAre(0, 1));
  EXPECT_THAT(rig.model.transient_sensors->front, ElementsAre(2, 3));
  const auto& [a, b, h, e_pa, nu] = rig.model.plate;
  EXPECT_EQ(std::tuple(a.value, b.value, h.value, e_pa, nu), std::tuple(430.0, 400.0, 3.0, 2e11, 0.3));
  EXPECT_EQ(rig.model.support.kind, physics::SupportKind::Edges);
  EXPECT_EQ(rig.model.support.inset.value, 10.75);
  EXPECT_EQ(rig.rate, core::Rate::from_hz(200.0).value());
  EXPECT_EQ(rig.block_scans, 10U);
  ASSERT_TRUE(rig.trigger);
  EXPECT_EQ(std::tuple(rig.trigger->channel, rig.trigger->level, rig.trigger->hysteresis, rig.trigger->edges),
            std::tuple(6U, 1.5, 0.25, pipeline::TriggerEdges::Both));
  EXPECT_EQ(rig.sync_pulse_ms, 80.0);
  EXPECT_THAT(rig.published, ElementsAre("raw"));
  EXPECT_THAT(rig.recorded, ElementsAre("raw", "cop"));
  std::vector<std::tuple<std::string, double, double, double>> sensors;
  for (const auto& [label, position, curve, gap, origin] : rig.model.sensors) {
    sensors.emplace_back(label, position.x.value, position.y.value, gap.value);
    EXPECT_EQ(curve.name(), "c");
    EXPECT_EQ(curve.maximum_gap().value, 13.0);
    EXPECT_EQ(origin.sensor, "");
  }
  EXPECT_THAT(sensors, ElementsAre(std::tuple("w1", 86, 87, 11.5), std::tuple("w2", 344, 88, 12), std::tuple("w3", 85, 343, 12),
                                   std::tuple("w4", 343, 344, 12)));
  EXPECT_THAT(rig.sensor_channels, ElementsAre(30, 1, 2, 3));
  ASSERT_EQ(rig.stages.size(), 4U);
  EXPECT_THAT(rig.stages[0].options, testing::IsEmpty());
  EXPECT_THAT(rig.stages[1].options, ElementsAre(testing::Pair("window_scans", pipeline::OptionValue(5.0))));
  EXPECT_EQ(rig.stages[2].id, "linearise");
  EXPECT_THAT(rig.stages[3].options, ElementsAre(testing::Pair("estimator", pipeline::OptionValue("thesis"))));
}

TEST_F(RigFile, OriginOfAMeasuredCurve_ReachesItsSensor) {
  const std::string measured =
      "curve = { name = \"c\", point = [{ gap_mm = 4, volts = 4 }, { gap_mm = 13, volts = 1 }], calibration = { rig = \"floor\", sensor = "
      "\"w1\", daq_model = \"M\", daq_serial = \"7\", channel = \"CH0\" } }";
  const std::string plate_and_support = kTop.substr(0, kTop.find("[acquire]")).substr(kTop.find("[plate]"));
  Problems problems;
  const auto rig = read(plate_and_support + edited(sensor("w1", "86", "86"), "curve", measured) + stage("guard"), problems);

  ASSERT_EQ(text_of(problems), "");
  ASSERT_EQ(rig.model.sensors.size(), 1U);
  const auto& [created_utc, from, label, daq_model, daq_serial, channel] = rig.model.sensors[0].curve_origin;
  EXPECT_EQ(std::tuple(created_utc, from, label, daq_model, daq_serial, channel), std::tuple("", "floor", "w1", "M", "7", "CH0"));
}

TEST_F(RigFile, WhatMayBeLeftOut_TakesItsDefault) {
  const std::string plate_and_support = kTop.substr(0, kTop.find("[acquire]")).substr(kTop.find("[plate]"));
  Problems problems;
  const auto rig = read("trigger = { channel = 7 }\n" + plate_and_support + sensor("w1", "86", "86") + stage("guard"), problems);

  EXPECT_EQ(text_of(problems), "");
  EXPECT_EQ(rig.kind, "floor");
  EXPECT_FALSE(rig.model.transient_sensors || rig.cop_calibration || rig.trunk_model);
  EXPECT_EQ(rig.rate, core::Rate::from_hz(100.0).value());
  EXPECT_EQ(rig.block_scans, 1U);
  EXPECT_EQ(rig.sync_pulse_ms, 0.0);
  EXPECT_EQ(rig.sync_pulse_every_ms, 0.0);
  EXPECT_EQ(rig.trigger->edges, pipeline::TriggerEdges::Rising);
  EXPECT_EQ(rig.trigger->level, pipeline::TriggerInput().level);
  EXPECT_EQ(rig.trigger->hysteresis, pipeline::TriggerInput().hysteresis);
  EXPECT_THAT(rig.published, testing::IsEmpty());
  EXPECT_THAT(rig.recorded, testing::IsEmpty());
  const auto with = [&](const std::string& line, const std::string& by) { return read(edited(kRig, line, by), problems); };
  EXPECT_THAT(with("[publish]", "[publish]\n[other]").published, testing::IsEmpty());
  EXPECT_EQ(with("[trigger]", "[other]").trigger, std::nullopt);
  EXPECT_EQ(with("low_latency", "low_latency = true").block_scans, 1U);
  EXPECT_EQ(with("edges", "edges = \"falling\"").trigger->edges, pipeline::TriggerEdges::Falling);
  EXPECT_EQ(with("edges", "edges = \"rising\"").trigger->edges, pipeline::TriggerEdges::Rising);
}

TEST_F(RigFile, Limits_AreReportedWithPlaceAndRange) {
  const auto sensors = [](int count) {
    std::string text;
    for (int k = 0; k < count; ++k) text += sensor("s" + std::to_string(k), "1", "1", "channel = " + std::to_string(k + 16) + "\n");
    return text;
  };
  const std::string flat = "curve = { name = \"c\", point = [{ gap_mm = 4, volts = 4 }, { gap_mm = 11.5, volts = 1 }] }";
  const std::string exact = "curve = { name = \"c\", point = [{ gap_mm = 11, volts = 4 }, { gap_mm = 12, volts = 1 }] }";
  const std::string from12 = "curve = { name = \"c\", point = [{ gap_mm = 12, volts = 4 }, { gap_mm = 13, volts = 1 }] }";
  expect_problems(
      kRig,
      {
          {"kind", "kind = \"char\"", "rig:1:8: kind = \"char\" is not known; did you mean \"chair\"?; known: \"floor\", \"chair\""},
          {"kind", "kind = 3", "rig:1:8: kind must be a text in quotes"},
          {"kind", "kind = \"floor\"\nspeed = 1", "rig:2:1: unknown key 'speed'"},
          {"transient", R"(transient_sensors = ["w1", "w2", "w3"])",
           "rig:2:21: name four sensors: rear left, rear right, front left, front right"},
          {"transient", R"(transient_sensors = ["w1", "w2", "w3", "w5"])", "rig:2:21: there is no sensor labelled 'w5'"},
          {"transient", R"(transient_sensors = ["w1", "w2", "w3", "w2"])", "rig:2:21: sensor 'w2' is named twice"},
          {"transient", R"(transient_sensors = ["w2", "w1", "w3", "w4"])",
           "rig:2:21: the order is rear left, rear right, front left, front right; y grows to the front, x to the right"},
          {"transient", R"(transient_sensors = ["w1", "w2", "w4", "w3"])",
           "rig:2:21: the order is rear left, rear right, front left, front right; y grows to the front, x to the right"},
          {"transient", R"(transient_sensors = ["w3", "w4", "w1", "w2"])",
           "rig:2:21: the order is rear left, rear right, front left, front right; y grows to the front, x to the right"},
          {"transient", R"(transient_sensors = ["w1", "w4", "w3", "w2"])",
           "rig:2:21: the order is rear left, rear right, front left, front right; y grows to the front, x to the right"},
          {"transient", "transient_sensors = []", "rig:2:21: name four sensors: rear left, rear right, front left, front right"},
          {"[plate]", "[plates]",
           "rig: [plate] is missing\n"
           "rig:3:2: unknown key 'plates'; did you mean 'plate'?"},
          {"nu", "nu = 0.3\nrho = 1", "rig:9:1: unknown key 'rho' in [plate]"},
          {"inset_mm", "insets_mm = 1", "rig:11:1: unknown key 'insets_mm' in [support]; did you mean 'inset_mm'?"},
          {"kind = \"edges\"", "kind = \"edge\"",
           "rig:10:8: [support] kind = \"edge\" is not known; did you mean \"edges\"?; known: \"corner\", \"edges\", \"x-edges\", "
           "\"clamped\""},
          {"low_latency", "low_latency = 1", "rig:15:15: [acquire] low_latency must be true or false"},
          {"low_latency", "latency = true", "rig:15:1: unknown key 'latency' in [acquire]"},
          {"channel = 6", "channel = 2", "rig:17:11: channel 2 belongs to a sensor"},
          {"channel = 6", "", "rig:16:1: [trigger] channel is missing"},
          {"edges", "edges = \"up\"\nlevl = 2",
           "rig:20:9: [trigger] edges = \"up\" is not known; known: \"rising\", \"falling\", \"both\"\n"
           "rig:21:1: unknown key 'levl' in [trigger]; did you mean 'level'?"},
          {"sync_pulse_ms", "sync_pulse_ms = 10001\nsync_puls_ms = 1",
           "rig:22:17: [session] sync_pulse_ms = 10001 is out of range; allowed: 0 .. 10000\n"
           "rig:23:1: unknown key 'sync_puls_ms' in [session]; did you mean 'sync_pulse_ms'?"},
          {"streams", "streams = [1]\nstream = 1",
           "rig:24:12: [publish] streams must hold texts in quotes\n"
           "rig:25:1: unknown key 'stream' in [publish]; did you mean 'streams'?"},
          {"streams = [\"raw\", \"cop\"]", "streams = []\nstream = 1",
           "rig:26:11: [record] streams is empty; leave it out to record all streams of the rig\n"
           "rig:27:1: unknown key 'stream' in [record]; did you mean 'streams'?"},
          {"[[sensor]]", sensors(12) + "[[sensor]]", ""},
          {"[[sensor]]", sensors(13) + "[[sensor]]",
           "rig:27:1: a rig has 1 to 16 [[sensor]] tables, this one 17\n"
           "rig:122:1: channel 16 already belongs to another sensor"},
          {"label", "",
           "rig:27:1: [[sensor]] label is missing\n"
           "rig:2:21: there is no sensor labelled 'w1'"},
          {"label", "label = \"w2\"",
           "rig:35:9: another sensor is labelled 'w2' too\n"
           "rig:2:21: there is no sensor labelled 'w1'"},
          {"x_mm = 86", "x_mm = 430.1\ncolour = 1",
           "rig:29:8: [[sensor]] x_mm = 430.1 is out of range; allowed: 0 .. 430\n"
           "rig:30:1: unknown key 'colour' in [[sensor]]"},
          {"x_mm = 86", "x_mm = 430",
           "rig:2:21: the order is rear left, rear right, front left, front right; y grows to the front, x to the right"},
          {"channel = 30", "channel = 2", "rig:39:1: channel 2 already belongs to another sensor"},
          {"unloaded_gap_mm", "", ""},
          {"curve", flat, ""},
          {"unloaded_gap_mm", edited(sensor("w9", "1", "1", "channel = 9"), "curve", flat),
           "rig:37:9: the curve covers gaps of 4 .. 11.5 mm, without the unloaded plate's 12 mm (unloaded_gap_mm)"},
          {"unloaded_gap_mm", edited(sensor("w9", "1", "1", "channel = 9"), "curve", exact), ""},
          {"unloaded_gap_mm", edited(sensor("w9", "1", "1", "channel = 9"), "curve", from12), ""},
          {"curve", "curve = { name = \"c\", point = [] }", "rig:31:31: [curve] point must be written as [[point]]"},
          {"curve", "curve = \"file.toml\"",
           "rig:31:9: [[sensor]] curve names a file, but a recorded definition must contain the table itself"},
          {"id = \"guard\"", "id = \"gard\"", "rig:50:6: unknown stage 'gard'; did you mean 'guard'?"},
          {"id = \"guard\"", "",
           "rig:49:1: [[stage]] id is missing\n"
           "rig:49:1: unknown stage ''; known: guard, window_filter, linearise, cop, steadiness, transient, reach, classify, force_plate, "
           "force_cop"},
          {"window_scans", "window_scans = true", "rig:53:16: an option must be a number or a text in quotes"},
          {"window_scans", "window_scans = 5\nwindow = 5",
           "rig:52:6: unknown option 'window' of stage window_filter; known: window_scans, window_ms, shift_scans"},
      },
      read);
  expect_ranges(kRig,
                {
                    {"rate_hz", "[acquire]", "1", "20000", "0.9", "20000.1"},
                    {"block_ms", "[acquire]", "0.05", "1000", "0.04", "1000.1"},
                    {"channel = 6", "[trigger]", "0", "31", "-1", "32"},
                    {"level", "[trigger]", "-1000000", "1000000", "-1100000", "1100000"},
                    {"hysteresis", "[trigger]", "0", "1000000", "-0.1", "1100000"},
                    {"sync_pulse_ms", "[session]", "0", "10000", "-0.1", "11000"},
                    {"x_mm = 86", "[[sensor]]", "0", "430", "-0.1", "473"},
                    {"y_mm = 87", "[[sensor]]", "0", "400", "-0.1", "400.1"},
                    {"channel = 30", "[[sensor]]", "0", "31", "-1", "32"},
                    {"unloaded_gap_mm", "[[sensor]]", "4", "13", "3.9", "13.1"},
                },
                read);
  expect_problems(
      edited(kRig, "rate_hz", "rate_hz = 8192"),
      {{"block_ms", "block_ms = 500", ""},
       {"block_ms", "block_ms = 501", "rig:14:12: a block would have 4104 scans; at most 4096 are supported: lower block_ms or rate_hz"}},
      read);
}

TEST_F(RigFile, SyncPulseTrain_NeedsAPulseThatEndsBeforeTheNext) {
  Problems problems;
  EXPECT_EQ(read(edited(kRig, "sync_pulse_ms", "sync_pulse_ms = 80\nsync_pulse_every_ms = 1000"), problems).sync_pulse_every_ms, 1000.0);
  EXPECT_EQ(text_of(problems), "");
  expect_problems(
      kRig,
      {{"sync_pulse_ms", "sync_pulse_ms = 80\nsync_pulse_every_ms = 180", ""},
       {"sync_pulse_ms", "sync_pulse_ms = 80\nsync_pulse_every_ms = 179",
        "rig:23:23: [session] sync_pulse_every_ms must be at least 100 ms longer than sync_pulse_ms"},
       {"sync_pulse_ms", "sync_pulse_every_ms = 1000", "rig:22:23: [session] sync_pulse_every_ms needs a pulse: set sync_pulse_ms"},
       {"sync_pulse_ms", "sync_pulse_ms = 80\nsync_pulse_every_ms = 60001",
        "rig:23:23: [session] sync_pulse_every_ms = 60001 is out of range; allowed: 0 .. 60000"}},
      read);
}

TEST_F(RigFile, MissingTables_AreEachReportedOnce) {
  Problems problems;
  (void)read("", problems);
  EXPECT_EQ(text_of(problems),
            "rig: [plate] is missing\n"
            "rig:1:1: a rig has 1 to 16 [[sensor]] tables, this one 0\n"
            "rig:1:1: the rig has no [[stage]]: at least \"guard\" is needed");
}

TEST_F(RigFile, PlateAndSupport_TakeExactlyWhatPhysicsTakes) {
  struct Row {
    physics::Plate plate;
    physics::Support support;
    std::string problems;
  };
  using physics::SupportKind;
  for (const auto& [plate, support, expected] : {
           Row{{}, {.kind = SupportKind::Corner}, ""},
           {{}, {.kind = SupportKind::Edges}, ""},
           {{}, {.kind = SupportKind::XEdges}, ""},
           {{}, {.kind = SupportKind::Clamped}, ""},
           {{.nu = -0.999999}, {}, ""},
           {{.nu = -1.0}, {}, "rig:6:6: nu = -1 is out of range; allowed: -1 .. 0.5 without -1"},
           {{.nu = -1.1}, {}, "rig:6:6: [plate] nu = -1.1 is out of range; allowed: -1 .. 0.5"},
           {{.nu = 0.499999}, {}, ""},
           {{.nu = 0.5}, {}, "rig:6:6: nu = 0.5 is out of range; allowed: -1 .. 0.5 without 0.5"},
           {{.h = {0.01}}, {}, ""},
           {{.h = {0.0099}}, {}, "rig:4:8: [plate] h_mm = 0.0099 is out of range; allowed: 0.01 .. 86"},
           {{.h = {86.0}}, {}, ""},
           {{.h = {86.1}}, {}, "rig:4:8: [plate] h_mm = 86.1 is out of range; allowed: 0.01 .. 86"},
           {{.a = {500.0}, .b = {400.0}, .h = {80.1}}, {}, "rig:4:8: [plate] h_mm = 80.1 is out of range; allowed: 0.01 .. 80"},
           {{.a = {10.0}, .b = {10.0}, .h = {1.0}}, {}, ""},
           {{.a = {9.9}, .b = {10.0}, .h = {1.0}},
            {},
            "rig:2:8: [plate] a_mm = 9.9 is out of range; allowed: 10 .. 10000\n"
            "rig:2:8: [plate] a_mm and b_mm: one side is more than 20 times the other"},
           {{.a = {10.0}, .b = {9.9}, .h = {1.0}},
            {},
            "rig:3:8: [plate] b_mm = 9.9 is out of range; allowed: 10 .. 10000\n"
            "rig:2:8: [plate] a_mm and b_mm: one side is more than 20 times the other"},
           {{.a = {10'000.0}, .b = {10'000.0}}, {}, ""},
           {{.a = {10'001.0}, .b = {10'000.0}},
            {},
            "rig:2:8: [plate] a_mm = 10001 is out of range; allowed: 10 .. 10000\n"
            "rig:2:8: [plate] a_mm and b_mm: one side is more than 20 times the other"},
           {{.a = {10'000.0}, .b = {10'001.0}},
            {},
            "rig:3:8: [plate] b_mm = 10001 is out of range; allowed: 10 .. 10000\n"
            "rig:2:8: [plate] a_mm and b_mm: one side is more than 20 times the other"},
           {{.a = {200.0}, .b = {10.0}, .h = {1.0}}, {}, ""},
           {{.a = {201.0}, .b = {10.0}, .h = {1.0}}, {}, "rig:2:8: [plate] a_mm and b_mm: one side is more than 20 times the other"},
           {{.a = {10.0}, .b = {201.0}, .h = {1.0}}, {}, "rig:2:8: [plate] a_mm and b_mm: one side is more than 20 times the other"},
           {{.e_pa = 1e5}, {}, ""},
           {{.e_pa = 9e4}, {}, "rig:5:8: [plate] e_pa = 90000 is out of range; allowed: 100000 .. 1e+13"},
           {{.e_pa = 1e13}, {}, ""},
           {{.e_pa = 1.1e13}, {}, "rig:5:8: [plate] e_pa = 1.1e+13 is out of range; allowed: 100000 .. 1e+13"},
           {{}, {.inset = {214.9}}, ""},
           {{}, {.inset = {215.0}}, "rig:9:12: inset_mm = 215 is out of range; allowed: 0 .. 215 without 215"},
           {{.a = {500.0}, .b = {400.0}}, {.inset = {200.0}}, "rig:9:12: inset_mm = 200 is out of range; allowed: 0 .. 200 without 200"},
           {{}, {.inset = {-0.1}}, "rig:9:12: [support] inset_mm = -0.1 is out of range; allowed: 0 .. 215"},
       }) {
    constexpr std::array<const char*, 4> kKinds{"corner", "edges", "x-edges", "clamped"};
    std::ostringstream text;
    text.precision(17);
    text << "[plate]\na_mm = " << plate.a.value << "\nb_mm = " << plate.b.value << "\nh_mm = " << plate.h.value << "\ne_pa = " << plate.e_pa
         << "\nnu = " << plate.nu << "\n[support]\nkind = \"" << kKinds[static_cast<std::size_t>(support.kind)]
         << "\"\ninset_mm = " << support.inset.value << "\n"
         << sensor("w1", "5", "5") << stage("guard");
    Problems problems;
    const auto rig = read(text.str(), problems);
    EXPECT_EQ(text_of(problems), expected) << text.str();
    EXPECT_EQ(physics::check_plate(plate) && physics::check_support(plate, support), problems.empty()) << text.str();
    EXPECT_EQ(rig.model.support.kind, support.kind);
  }
}

TEST_F(RigFile, CurvesOfFiles_AreReadOnceAndReportedWithTheirOwnPlace) {
  const std::string by_file = edited(edited(kRig, "curve", "curve = \"short.toml\""), "curve = {", "curve = \"short.toml\"");
  write("short.toml", "name = \"short\"\n[[point]]\ngap_mm = 7\nvolts = 4\n[[point]]\ngap_mm = 11.5\nvolts = 2\n");
  Problems problems;
  (void)read_rig_file(write("rig.toml", by_file), problems);
  EXPECT_EQ(text_of(problems),
            "rig.toml:38:9: the curve covers gaps of 7 .. 11.5 mm, without the unloaded plate's 12 mm (unloaded_gap_mm)");
  write("short.toml", "name = \"short\"\nvolts = 3\n");
  problems.clear();
  (void)read_rig_file(path("rig.toml"), problems);
  EXPECT_EQ(text_of(problems), "short.toml:2:1: unknown key 'volts'");
  std::filesystem::remove(path("short.toml"));
  problems.clear();
  (void)read_rig_file(path("rig.toml"), problems);
  EXPECT_EQ(text_of(problems), "rig.toml:31:9: short.toml cannot be read: No such file or directory");
}

}  // namespace
}  // namespace dts::files
