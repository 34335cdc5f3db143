// SPDX-License-Identifier: Apache-2.0
// All that a stage gives for a made-up signal with faults, with each option at both ends of its range, against outputs/: descriptions,
// formats, sums over every value and every quality bit, every number of every event, the saved state.
#include <gtest/gtest.h>

#include <sstream>

#include "contract/stage_contract.h"
#include "support/committed_text.h"
#include "unit/pipeline/chair_chain.h"

namespace dts::pipeline {
namespace {

using contract::numbers_of;
using contract::Options;
using contract::PreparedStage;

double weight(std::size_t i) { return 1.0 + static_cast<double>(i * 7919 % 1009) / 1009.0; }

/// First and last number, and a sum in which every one has a weight of its own; those that are missing are counted.
template <class Numbers>
std::string sums_of(const Numbers& numbers) {
  double sum = 0.0;
  double missing = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = static_cast<double>(numbers[i]);
    (std::isnan(number) ? missing : sum) += weight(i) * (std::isnan(number) ? 1.0 : number);
  }
  std::ostringstream text;
  text.precision(12);
  text << numbers.size() << " : ";
  if (numbers.size() > 0) text << static_cast<double>(numbers[0]) << " .. " << static_cast<double>(numbers.back()) << " ";
  text << "sum " << sum << " missing " << missing;
  return text.str();
}

template <class Event>
void write_events(std::ostream& text, const char* what, const std::vector<Event>& events) {
  for (const Event& event : events) {
    text << "  " << what;
    for (const double number : numbers_of(event)) text << ' ' << number;
    text << '\n';
  }
}

void write_description(std::ostream& text, const StageDescription& is) {
  text << is.id << " makes '" << is.output_stream << "': " << is.sentence << '\n';
  for (const OptionDescription& option : is.options) {
    text << "option " << option.name << ": " << option.default_value << " from " << option.minimum << " to " << option.maximum
         << (option.is_whole ? " whole" : "");
    for (const std::string_view choice : option.choices) text << ' ' << choice;
    text << ": " << option.sentence << '\n';
  }
}

void write_output(std::ostream& text, const std::string& id, const Options& options, std::size_t scans, Faults faults) {
  text << contract::text_of(options) << (faults == Faults::None ? " without faults" : "") << '\n';
  PreparedStage stage(id, options);
  if (!stage.is_prepared()) {
    text << "  takes none of the signals\n";
    return;
  }
  text << "  rate " << stage.format().rate.numerator() << " / " << stage.format().rate.denominator() << " , delay "
       << stage.format().delay_ns << " ns,";
  for (const core::ChannelFormat& channel : stage.format().channels) text << ' ' << channel.name << " '" << channel.unit << "'";
  const Output output = stage.run(stage.signal(scans, 3, faults));
  text << "\n  scans " << sums_of(output.scan) << "\n  times " << sums_of(output.block_host_time_ns) << '\n';
  for (std::size_t c = 0; c < output.values.size(); ++c) {
    text << "  channel " << c << " : " << sums_of(output.values[c]) << " bits " << sums_of(output.bits[c]) << '\n';
  }
  write_events(text, "reach", output.reaches);
  write_events(text, "class", output.classes);
  write_events(text, "sway", output.sways);
  text << "  lost " << output.lost_sways << " state " << sums_of(contract::saved(*stage)) << '\n';
}

class StageOutput : public contract::StageContract {};

TEST_P(StageOutput, WithEveryOption_IsThatOfItsFile) {
  const std::string id = GetParam();
  const std::size_t scans = id == "reach" || id == "steadiness" ? 3000 : 700;  // reaches and quiet standing take seconds
  std::ostringstream text;
  text.precision(12);
  write_description(text, description());
  for (const Options& options : contract::option_sets(description())) {
    write_output(text, id, options, scans, Faults::Some);
    if (options.empty() || id == "steadiness") write_output(text, id, options, scans, Faults::None);
  }
  // The least squares of an estimator make the last digits of another processor larger: arm64 differs by 6e-9.
  dts::test::expect_committed("unit/pipeline/outputs/" + id + ".txt", text.str(), id == "cop" ? 1e-7 : 1e-9);
}

std::vector<std::string> ids_of_stages() {
  std::vector<std::string> ids;
  for (const StageEntry& entry : stage_registry()) ids.emplace_back(entry.describe().id);
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Stages, StageOutput, testing::ValuesIn(ids_of_stages()), [](const auto& stage) { return stage.param; });

/// At 1500 Hz a scan of the analysis is a block of scans. Two people, one with doubtful sensors.
TEST(ReachOutput, At1500Hz_IsThatOfItsFile) {
  std::ostringstream text;
  text.precision(12);
  const SeatedPerson person{.noise_mm = 0.002,
                            .reaches = {{}, {.start_s = 6.0, .rise_mm = 0.6}, {.start_s = 9.5, .dip_mm = 0.1, .hold_s = 1.5}},
                            .sits_down_s = 0.7,
                            .stands_up_s = 15.0};
  for (const Faults faults : {Faults::None, Faults::Some}) {
    Signal signal = transient_of(person, 16.0, 1500.0);
    for (std::size_t i = 0; i < signal.scans() && faults == Faults::Some; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (i % 7000 < 400) signal.bits[c][i] |= c == 0 ? core::quality::kSubstituted : core::quality::kUncalibrated;  // the first counts
        if (i % 5000 < 12) signal.values[c][i] = contract::kNaN;
      }
    }
    write_events(text, faults == Faults::None ? "reach" : "doubtful reach", reaches_of(signal, 64));
  }
  dts::test::expect_committed("unit/pipeline/outputs/reach_1500.txt", text.str(), 1e-9);
}

}  // namespace
}  // namespace dts::pipeline
