// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "ctl/watch_sink.h"

namespace dts::ctl {

/// A table of streams that is redrawn in place ten times per second. Events scroll above it; running sway values are in lines below it.
///
///     12.4 s  floor  marker: eyes closed
///     TOPIC      RATE (Hz)     AGE  LOST  VALUES
///     floor/cop      100.1  1.2 ms     0  ml 1.2300 mm  ap -4.5600 mm  load 701.20 N
///     floor/sway: preliminary, trial 1, 12.5 s: velocity (MVELO) 8.12 mm/s
///
/// Values that do not fit into the terminal's width move to a second line. A terminal that is too narrow for the columns shows no AGE, then
/// no RATE. A topic is never cut.
class LiveTable final : public WatchSink {
 public:
  explicit LiveTable(cli::Console& console) : console_(console) {}

  void show(const client::Block& block, std::size_t scans, Time now) override;
  void show(const client::Event& event) override;
  void show(const client::Status& status) override;
  void forget() override {
    rows_.clear();
    running_.clear();
  }
  void make_room() override { lines_drawn_ = 0; }
  void refresh(Time now) override;

 private:
  /// Kept as numbers: text is made only when it is drawn, ten times per second, not for each block.
  struct Row {
    const client::StreamFormat* format = nullptr;
    std::vector<float> scan;
    std::vector<std::uint8_t> quality;
    std::optional<std::int64_t> age_ns;  ///< Age at the time `seen`.
    Time seen{};
    std::uint64_t lost_scans = 0;  ///< Total.
    Time since{};                  ///< Start of the second over which the rate is counted.
    std::uint64_t scans_since = 0;
    double rate_hz = std::numeric_limits<double>::quiet_NaN();
  };
  /// The last preliminary sway values, by topic.
  struct Running {
    std::string text;
    Time seen{};
  };
  [[nodiscard]] static std::string age_text(const Row& row, Time now);
  void erase();
  void draw(Time now);
  void draw_rows(Time now);
  void draw_running(Time now);
  /// Returns false and draws nothing if there is no room for all the lines.
  bool draw_lines(const std::vector<std::string>& lines, cli::Style style);
  void put(const std::string& line);

  cli::Console& console_;
  std::map<std::string, Row, std::less<>> rows_;
  std::map<std::string, Running, std::less<>> running_;
  std::size_t lines_drawn_ = 0;
  Time drawn_{};
};

}  // namespace dts::ctl
