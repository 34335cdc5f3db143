// SPDX-License-Identifier: Apache-2.0
#include "ctl/csv_lines.h"

#include <array>
#include <charconv>
#include <cmath>
#include <ostream>

namespace dts::ctl {
namespace {

template <class Number>
void append_number(std::string& text, Number number) {
  std::array<char, 64> digits{};
  text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), number).ptr);
}

}  // namespace

void CsvLines::begin(const client::Block& block) {
  topic_ = block.topic;
  text_ = "segment,scan";
  for (const client::ChannelFormat& channel : block.format->channels) text_ += "," + cli::csv_cell(cli::printable(channel.name));
  text_ += '\n';
}

void CsvLines::show(const client::Block& block, std::size_t scans, Time /*now*/) {
  text_.clear();
  if (topic_.empty()) begin(block);
  if (block.topic != topic_) {
    if (!has_reported_other_)
      cli::print_error(console_, std::string(block.topic) + " is left out: CSV output has one stream only",
                       "give one stream as TOPIC-PREFIX");
    has_reported_other_ = true;
    return;
  }
  for (std::size_t scan = 0; scan < scans; ++scan) {
    append_number(text_, block.segment);
    text_ += ',';
    append_number(text_, block.first_scan + scan);
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      text_ += ',';
      if (const float value = block.values[channel * block.scan_count + scan]; std::isfinite(value)) append_number(text_, value);
    }
    text_ += '\n';
  }
  console_.out << text_ << std::flush;
}

}  // namespace dts::ctl
