// SPDX-License-Identifier: Apache-2.0
#include "ctl/live_table.h"

#include <algorithm>
#include <string_view>

#include "cli/table.h"
#include "ctl/reading.h"
#include "ctl/screen.h"
#include "ctl/sway_reading.h"
#include "ctl/text_lines.h"

namespace dts::ctl {
namespace {

constexpr std::chrono::milliseconds kRedraw{100};
constexpr std::chrono::seconds kRateWindow{1};
constexpr std::chrono::seconds kFrozen{2};
constexpr std::string_view kValuesIndent = "    ";

std::string padded(const std::string& text, std::size_t columns, bool is_right) {
  const std::string padding(columns > cli::width(text) ? columns - cli::width(text) : 0, ' ');
  return is_right ? padding + text : text + padding;
}

}  // namespace

void LiveTable::show(const client::Block& block, std::size_t scans, Time now) {
  const auto known = rows_.find(block.topic);
  const bool is_new = known == rows_.end();
  Row& row = is_new ? rows_[std::string(block.topic)] : known->second;
  row.format = block.format;
  copy_scan(block, scans - 1, row.scan);
  row.quality.assign(block.quality.begin(), block.quality.end());
  row.age_ns = block.age_ns;
  row.seen = now;
  row.lost_scans += block.lost_scans;
  if (is_new) {
    row.since = now;  // the first block arrived before the measured time
    return;
  }
  row.scans_since += scans;
  if (now - row.since < kRateWindow) return;
  row.rate_hz = static_cast<double>(row.scans_since) / std::chrono::duration<double>(now - row.since).count();
  row.since = now;
  row.scans_since = 0;
}

void LiveTable::show(const client::Event& event) {
  if (event.body->has_sway() && event.body->sway().is_preliminary()) {
    running_[std::string(event.topic)] = {.text = sway_text(event.body->sway()), .seen = drawn_};
  } else {
    put(std::string(event.rig) + "  " + event_line(event));
  }
}

void LiveTable::show(const client::Status& status) { put(status_line(*status.snapshot)); }

void LiveTable::put(const std::string& line) {
  erase();
  console_.out << cli::styled(console_, cli::Style::Bold, cli::printable(line)) << '\n';
  console_.out.flush();
}

void LiveTable::refresh(Time now) {
  if (now - drawn_ < kRedraw && lines_drawn_ > 0) return;
  erase();
  draw(now);
  console_.out.flush();
}

void LiveTable::erase() {
  ctl::erase(console_, lines_drawn_);
  lines_drawn_ = 0;
}

void LiveTable::draw(Time now) {
  drawn_ = now;
  if (!rows_.empty()) draw_rows(now);
  draw_running(now);
}

void LiveTable::draw_rows(Time now) {
  std::size_t topic_columns = 5;
  for (const auto& [topic, row] : rows_) topic_columns = std::max(topic_columns, cli::width(topic));
  constexpr std::size_t kRateColumns = 2 + 9;
  constexpr std::size_t kAgeColumns = 2 + 9;
  constexpr std::size_t kLostColumns = 2 + 6;
  const bool has_rate = topic_columns + kRateColumns + kLostColumns <= console_.columns;
  const bool has_age = topic_columns + kRateColumns + kAgeColumns + kLostColumns <= console_.columns;
  const auto line = [&](const std::string& topic, const std::string& rate, const std::string& age, const std::string& lost) {
    return padded(topic, topic_columns, false) + (has_rate ? padded(rate, kRateColumns, true) : "") +
           (has_age ? padded(age, kAgeColumns, true) : "") + padded(lost, kLostColumns, true);
  };
  const std::string headline = line("TOPIC", "RATE (Hz)", "AGE", "LOST");
  draw_lines({cli::filled({headline, "VALUES"}, "  ", console_.columns, "").front()}, cli::Style::Faint);
  std::size_t left_out = rows_.size();
  for (const auto& [topic, row] : rows_) {
    const bool is_frozen = now - row.seen > kFrozen;
    const std::string rate = is_frozen ? "-" : cli::decimal(row.rate_hz, 1);
    std::vector<std::string> parts{line(cli::printable(topic), rate, age_text(row, now), std::to_string(row.lost_scans))};
    for (std::string& part : reading_parts(*row.format, row.scan, row.quality)) parts.push_back(std::move(part));
    if (!draw_lines(cli::filled(parts, "  ", console_.columns, kValuesIndent), is_frozen ? cli::Style::Faint : cli::Style::Plain)) break;
    --left_out;
  }
  if (left_out > 0) console_.out << "and " << left_out << " more; give a topic prefix\n";
  lines_drawn_ += left_out > 0 ? 1 : 0;
}

void LiveTable::draw_running(Time now) {
  std::erase_if(running_, [now](const auto& entry) { return now - entry.second.seen > kFrozen; });
  for (const auto& [topic, running] : running_) {
    draw_lines(cli::wrapped(cli::printable(topic + ": " + running.text), console_.columns, kValuesIndent), cli::Style::Plain);
  }
}

/// The cursor cannot move above the screen: one line stays free for the cursor and one for "and n more".
bool LiveTable::draw_lines(const std::vector<std::string>& lines, cli::Style style) {
  constexpr std::size_t kKeptFree = 2;
  if (lines_drawn_ + lines.size() + kKeptFree > std::max<std::size_t>(console_.lines, kKeptFree + 2)) return false;
  for (const std::string& line : lines) console_.out << cli::styled(console_, style, line) << '\n';
  lines_drawn_ += lines.size();
  return true;
}

/// Returns the present age, not the age on arrival, so that old values never look current.
std::string LiveTable::age_text(const Row& row, Time now) {
  const std::chrono::duration<double, std::milli> waited = now - row.seen;
  if (waited > kFrozen) return cli::decimal(waited.count() / 1000.0, 0) + " s ago";
  return row.age_ns ? cli::decimal(static_cast<double>(*row.age_ns) * 1e-6 + waited.count(), 1) + " ms" : "-";
}

}  // namespace dts::ctl
