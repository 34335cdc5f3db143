// SPDX-License-Identifier: Apache-2.0
// All that a stage gives for a made-up signal with faults, with each option at both ends of its range, against outputs/: descriptions,
// formats, sums over every value and every quality bit, every number of every event, the saved state.
#include <gtest/gtest.h>

#include <sstream>

#include "contract/expected_text.h"
#include "contract/stage_contract.h"

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

void write_output(std::ostream& text, const std::string& id, const Options& options, std::size_t scans) {
  text << contract::text_of(options) << '\n';
  PreparedStage stage(id, options);
  if (!stage.is_prepared()) {
    text << "  takes none of the signals\n";
    return;
  }
  text << "  rate " << stage.format().rate.numerator() << " / " << stage.format().rate.denominator() << " , delay "
       << stage.format().delay_ns << " ns,";
  for (const core::ChannelFormat& channel : stage.format().channels) text << ' ' << channel.name << " '" << channel.unit << "'";
  const Output output = stage.run(stage.signal(scans, 3, Faults::Some));
  text << "\n  scans " << sums_of(output.scan) << "\n  times " << sums_of(output.block_host_time_ns) << '\n';
  for (std::size_t c = 0; c < output.values.size(); ++c) {
    text << "  channel " << c << " : " << sums_of(output.values[c]) << " bits " << sums_of(output.bits[c]) << '\n';
  }
  write_events(text, "reach", output.reaches);
  write_events(text, "class", output.classes);
  write_events(text, "sway", output.sways);
  text << "  lost " << output.lost_sways << " state " << sums_of(contract::saved(*stage)) << '\n';
}

TEST(StageOutput, OfEveryStageWithEveryOption_IsThatOfItsFile) {
  for (const StageEntry& entry : stage_registry()) {
    const StageDescription& description = entry.describe();
    std::ostringstream text;
    text.precision(12);
    write_description(text, description);
    // A reach takes seconds, and the chair's signal holds several.
    const std::size_t scans = description.id == "reach" ? 3000 : 700;
    for (const Options& options : contract::option_sets(description)) write_output(text, std::string(description.id), options, scans);
    dts::test::expect_text("tests/unit/pipeline/outputs/" + std::string(description.id) + ".txt", text.str());
  }
}

}  // namespace
}  // namespace dts::pipeline
