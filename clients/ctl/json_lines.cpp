// SPDX-License-Identifier: Apache-2.0
#include "ctl/json_lines.h"

#include <array>
#include <charconv>
#include <cmath>
#include <ostream>

#include "cli/table.h"
#include "ctl/json.h"

namespace dts::ctl {
namespace {

template <class Number>
void append(std::string& line, Number number) {
  std::array<char, 64> text{};
  line.append(text.data(), std::to_chars(text.begin(), text.end(), number).ptr);
}

template <class Number>
void append_field(std::string& line, const char* key, Number number) {
  line.append(",\"").append(key).append("\":");
  append(line, number);
}

void append_value(std::string& line, float value) {
  if (std::isfinite(value)) {
    append(line, value);
  } else {
    line += "null";
  }
}

void append_quality(std::string& line, const client::Block& block) {
  cli::Json doubts = cli::Json::object();
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
    const std::uint8_t bits = block.quality[channel];
    if (bits != 0) doubts[block.format->channels[channel].name] = quality_words(bits);
  }
  if (!doubts.empty()) line += ",\"quality\":" + cli::one_line(doubts);
}

void append_values(std::string& line, const client::Block& block, std::size_t scans) {
  line += ",\"values\":[";
  for (std::size_t scan = 0; scan < scans; ++scan) {
    line += scan == 0 ? "[" : ",[";
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      if (channel > 0) line += ',';
      append_value(line, block.values[channel * block.scan_count + scan]);
    }
    line += ']';
  }
  line += ']';
}

}  // namespace

void JsonLines::show(const client::Block& block, std::size_t scans, Time /*now*/) {
  const Fixed& fixed = fixed_of(block);
  line_ = fixed.head;
  append_field(line_, "segment", block.segment);
  append_field(line_, "first_scan", block.first_scan);
  append_field(line_, "rate_hz", block.rate.hz());
  append_field(line_, "host_time_ns", block.host_time_ns);
  append_field(line_, "host_time_uncertainty_ns", block.host_time_uncertainty_ns);
  append_field(line_, "instance_id", block.body->instance_id());
  append_field(line_, "sequence", block.sequence);
  append_field(line_, "lost_scans", block.lost_scans);
  if (!block.is_lost_exact) line_ += ",\"lost_scans_at_least\":true";
  if (block.age_ns) line_ += ",\"age_ms\":" + cli::decimal(static_cast<double>(*block.age_ns) * 1e-6, 3);
  append_quality(line_, block);
  line_ += fixed.channels;
  append_values(line_, block, scans);
  line_ += '}';
  write();
}

void JsonLines::show(const client::Event& event) {
  cli::Json json{{"topic", event.topic},
                 {"rig", event.rig},
                 {"event", event_json(event.kind, *event.body)},
                 {"segment", event.body->segment()},
                 {"first_scan", event.body->scan()}};
  if (event.body->has_host_time_ns()) json["host_time_ns"] = event.body->host_time_ns();
  json["instance_id"] = event.body->instance_id();
  line_ = cli::one_line(json);
  write();
}

void JsonLines::show(const client::Status& status) {
  cli::Json snapshot{{"kind", "status"}};
  snapshot.update(to_json(*status.snapshot));
  const cli::Json json{
      {"topic", "dtsd/status"}, {"rig", "dtsd"}, {"event", std::move(snapshot)}, {"host_time_ns", status.snapshot->host_time_ns()}};
  line_ = cli::one_line(json);
  write();
}

const JsonLines::Fixed& JsonLines::fixed_of(const client::Block& block) {
  const auto known = fixed_.find(block.topic);
  if (known != fixed_.end()) return known->second;
  Fixed fixed;
  fixed.head = cli::one_line(cli::Json{{"topic", block.topic}, {"rig", block.rig}, {"stream", block.stream}});
  fixed.head.pop_back();  // removes the closing brace, because more keys follow
  cli::Json names = cli::Json::array();
  cli::Json units = cli::Json::array();
  for (const client::ChannelFormat& channel : block.format->channels) {
    names.push_back(channel.name);
    units.push_back(channel.unit);
  }
  fixed.channels = ",\"channels\":" + cli::one_line(names) + ",\"units\":" + cli::one_line(units);
  return fixed_[std::string(block.topic)] = std::move(fixed);
}

void JsonLines::write() {
  line_ += '\n';
  out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
  out_.flush();
}

}  // namespace dts::ctl
