// SPDX-License-Identifier: Apache-2.0
// Prints how well dtsd follows the simulator's truth: one daemon, many rigs, real sockets, one Markdown table per question.
#include <sys/utsname.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <thread>

#include "accuracy/evaluation.h"

namespace dts::accuracy {
namespace {

struct NamedRecording {
  std::string name;
  std::string path;
  RecordingFile file;
};

constexpr std::array<const char*, 3> kRecordings = {"d01_bds00073_young_eo_firm", "d02_bds00079_young_ec_firm", "d03_acuna_eo2_1000hz"};
constexpr std::array<const char*, 2> kEstimators = {"poly3", "thesis"};
const std::array<Place, 2> kStances = {{{0.0, 0.0}, {30.0, -30.0}}};
const std::array<Place, 3> kWeights = {{{0.0, 0.0}, {60.0, -40.0}, {-100.0, 80.0}}};

using Rows = std::vector<std::pair<Case, Evaluation>>;

std::vector<NamedRecording> find_recordings() {
  std::vector<NamedRecording> found;
  const auto folder = std::filesystem::path(DTS_SOURCE_DIR).parent_path() / "shared" / "data" / "cop";
  for (const std::string name : kRecordings) {
    const std::string path = folder / (name + ".csv");
    if (auto file = read_recording(path)) found.push_back({name.substr(0, 3), path, std::move(*file)});
  }
  return found;
}

/// `make` for every converter and estimator.
template <class Make>
void add_all(std::vector<Case>& cases, Make make) {
  for (const DaqSetting* daq : {&thesis_daq(), &modern_daq(), &noise_free_daq()}) {
    for (const char* estimator : kEstimators) cases.push_back(make(*daq, estimator));
  }
}

std::vector<Case> all_cases(const std::vector<NamedRecording>& recordings, double seconds) {
  std::vector<Case> cases;
  for (const Place& place : kStances) {
    add_all(cases, [&](const auto& daq, const auto* estimator) { return stance_case(daq, estimator, place, seconds); });
  }
  for (const auto& recording : recordings) {
    add_all(cases, [&](const auto& daq, const auto* estimator) {
      return recording_case(daq, estimator, recording.name, recording.path, recording.file.duration_s(), seconds);
    });
  }
  for (const Place& place : kWeights) {
    add_all(cases, [&](const auto& daq, const auto* estimator) { return point_case(daq, estimator, place, seconds); });
  }
  return cases;
}

/// "(30, -30)"
std::string text(const Place& place) {
  return "(" + std::to_string(std::lround(place.ml_mm)) + ", " + std::to_string(std::lround(place.ap_mm)) + ")";
}

/// What sways: "d01", or synthetic sway and where.
std::string sway_of(const Case& wanted) {
  return wanted.kind == LoadKind::Recording ? wanted.rig.substr(0, 3) : "synthetic at " + text(wanted.place);
}

/// A row's last cells: how many scans were compared, how many are missing, and whether any was in doubt.
void print_counts(const Evaluation& e) {
  const std::size_t missing = e.expected_scans - e.compared_scans;
  std::printf(" | %zu | %llu%s |\n", e.compared_scans, static_cast<unsigned long long>(e.lost_scans + missing),
              e.doubts != 0 ? " (in doubt)" : "");
}

void print_following(const Rows& rows) {
  std::printf(
      "\n### Two feet, 686 N: published COP against true COP\n\n"
      "| sway | estimator | DAQ and window | RMSE ML / AP, mm (mean offset removed) | offset ML / AP, mm | gain ML / AP | rest ML / AP, mm "
      "(gain removed too) | load | scans | lost |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [wanted, e] : rows) {
    if (wanted.kind == LoadKind::Point) continue;
    std::printf("| %s | %s | %s | %.2f / %.2f | %+.1f / %+.1f | %.3f / %.3f | %.2f / %.2f | %+.1f %%", sway_of(wanted).c_str(),
                wanted.estimator.c_str(), wanted.daq.text.c_str(), e.ml.centred_rmse_mm, e.ap.centred_rmse_mm, e.ml.offset_mm,
                e.ap.offset_mm, e.ml.gain, e.ap.gain, e.ml.residual_mm, e.ap.residual_mm, 100.0 * e.load_error);
    print_counts(e);
  }
}

void print_points(const Rows& rows) {
  std::printf(
      "\n### Point load, 490 N: nothing removed\n\n"
      "| place from the centre, mm | estimator | DAQ and window | RMSE ML / AP / both, mm | mean error ML / AP, mm | scatter ML / AP, mm | "
      "load | "
      "scans | lost |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [wanted, e] : rows) {
    if (wanted.kind != LoadKind::Point) continue;
    std::printf("| %s | %s | %s | %.2f / %.2f / %.2f | %+.2f / %+.2f | %.2f / %.2f | %+.2f %%", text(wanted.place).c_str(),
                wanted.estimator.c_str(), wanted.daq.text.c_str(), e.ml.rmse_mm, e.ap.rmse_mm, std::hypot(e.ml.rmse_mm, e.ap.rmse_mm),
                e.ml.offset_mm, e.ap.offset_mm, e.ml.centred_rmse_mm, e.ap.centred_rmse_mm, 100.0 * e.load_error);
    print_counts(e);
  }
}

double percent(double value, double reference) { return 100.0 * (value / reference - 1.0); }

/// "+1.2 %", and in brackets the same against the file when the whole of it was played.
std::string error_text(double published, double truth, double in_file) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%+.1f %%", percent(published, truth));
  std::string result = text.data();
  if (!(in_file > 0.0)) return result;
  std::snprintf(text.data(), text.size(), " (%+.1f %%)", percent(published, in_file));
  return result + text.data();
}

void print_sway_row(const Case& wanted, const Evaluation& e, const SwayMeasures& in_file) {
  if (e.compared_scans != e.expected_scans) return;  // a hole would be filtered into a wrong figure
  const SwayMeasures truth = sway_measures_lp10(e.truth, e.rate_hz);
  const SwayMeasures published = sway_measures_lp10(e.published, e.rate_hz);
  std::printf("| %s | %s | %s | %.1f | %.1f | %s | %.1f | %.1f | %s |\n", sway_of(wanted).c_str(), wanted.estimator.c_str(),
              wanted.daq.text.c_str(), truth.path_length_mm, published.path_length_mm,
              error_text(published.path_length_mm, truth.path_length_mm, in_file.path_length_mm).c_str(), truth.ellipse_mm2,
              published.ellipse_mm2, error_text(published.ellipse_mm2, truth.ellipse_mm2, in_file.ellipse_mm2).c_str());
}

/// Of the file that a case plays; zeros when it plays none or only a part of it.
SwayMeasures measures_in_file(const Case& wanted, const std::vector<NamedRecording>& recordings) {
  for (const auto& [name, path, file] : recordings) {
    const bool is_whole = wanted.last_s - wanted.first_s > file.duration_s() - 1e-6;
    if (path == wanted.recording && is_whole) return sway_measures_lp10(file.locus, std::round(file.rate_hz));
  }
  return {};
}

void print_sway(const Rows& rows, const std::vector<NamedRecording>& recordings) {
  std::printf(
      "\n### Path length and 95 %% ellipse (PEA95), both after lp10\n\n"
      "Error of the published figure against the true COP of the same scans; in brackets against the recording's own file.\n\n"
      "| sway | estimator | DAQ and window | true path, mm | published path, mm | error | true PEA95, mm² | published PEA95, mm² | error "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [wanted, e] : rows) {
    if (wanted.kind != LoadKind::Point) print_sway_row(wanted, e, measures_in_file(wanted, recordings));
  }
}

/// The recordings as they stand in their files, and how exactly the simulator's truth repeats them.
void print_recordings(const std::vector<NamedRecording>& recordings, const Rows& rows, const Captures& captures) {
  std::printf(
      "\n### The recordings themselves\n\n"
      "| recording | rate | length | path lp10, mm | PEA95 lp10, mm² | largest distance of the simulator's truth from the file, mm |\n"
      "|---|---|---|---|---|---|\n");
  for (const auto& [name, path, file] : recordings) {
    const SwayMeasures measures = sway_measures_lp10(file.locus, std::round(file.rate_hz));
    double distance_mm = 0.0;
    for (const auto& [wanted, unused] : rows) {
      if (wanted.recording == path) {
        distance_mm = std::fmax(distance_mm, largest_truth_error_mm(wanted, captures.find(wanted.rig)->second, file));
      }
    }
    std::printf("| %s | %.0f Hz | %.2f s | %.1f | %.1f | %.0e |\n", name.c_str(), file.rate_hz, file.duration_s(), measures.path_length_mm,
                measures.ellipse_mm2, distance_mm);
  }
}

void print_machine(int argc, char** argv) {
  utsname system{};
  ::uname(&system);
  std::ifstream cpu("/proc/cpuinfo");
  std::string model = "unknown processor";
  for (std::string line; std::getline(cpu, line);) {
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  }
  std::string command = std::filesystem::path(argv[0]).filename();
  for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
  std::printf("Machine: %s, %u cores, Linux %s. Command: `%s`\n", model.c_str(), std::thread::hardware_concurrency(), system.release,
              command.c_str());
}

int report(double seconds) {
  const auto recordings = find_recordings();
  if (recordings.size() < kRecordings.size()) std::fprintf(stderr, "some recordings are absent: their rows are left out\n");
  const auto cases = all_cases(recordings, seconds);
  test::DaemonProcess daemon(daemon_options(cases));
  if (!daemon.is_ready()) {
    std::fprintf(stderr, "dtsd did not start:\n%s", daemon.log().c_str());
    return 1;
  }
  auto subscriber = daemon.subscribe(topics(cases));
  std::fprintf(stderr, "dtsd serves %zu rigs; receiving for %.0f s\n", cases.size(), kStandingFromS + seconds);
  const auto captures = capture(subscriber, cases);
  if (!captures) {
    std::fprintf(stderr, "%s; %s\n%s", captures.error().what.c_str(), captures.error().hint.c_str(), daemon.log().c_str());
    return 1;
  }
  Rows rows;
  bool is_whole = true;
  for (const Case& wanted : cases) {
    rows.emplace_back(wanted, evaluate(wanted, captures->find(wanted.rig)->second));
    const Evaluation& e = rows.back().second;
    is_whole = is_whole && e.lost_scans == 0 && e.compared_scans == e.expected_scans && e.doubts == 0;
  }
  print_following(rows);
  print_points(rows);
  print_sway(rows, recordings);
  print_recordings(recordings, rows, *captures);
  return is_whole ? 0 : 1;
}

}  // namespace
}  // namespace dts::accuracy

int main(int argc, char** argv) {
  CLI::App app{"Prints the accuracy of dtsd's centre of pressure as Markdown tables. Exit status 1 when a scan is lost or in doubt."};
  double seconds = 60.0;
  app.add_option("--seconds", seconds, "Quiet standing to compare, 2 to 600 s; recordings end where they end")
      ->check(CLI::Range(2.0, 600.0));
  CLI11_PARSE(app, argc, argv);
  dts::accuracy::print_machine(argc, argv);
  return dts::accuracy::report(seconds);
}
