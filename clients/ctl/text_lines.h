// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cli/console.h"
#include "ctl/watch_sink.h"

namespace dts::ctl {

/// Prints lines for people if a table cannot be redrawn: each event, and at most ten scans per second and stream (the newest).
class TextLines final : public WatchSink {
 public:
  explicit TextLines(cli::Console& console) : console_(console) {}

  void show(const client::Block& block, std::size_t scans, Time now) override;
  void show(const client::Event& event) override;
  void show(const client::Status& status) override;
  void forget() override {}
  void refresh(Time /*now*/) override {}

 private:
  struct Shown {
    Time at{};
    std::uint64_t unsaid_lost_scans = 0;
  };

  cli::Console& console_;
  std::map<std::string, Shown, std::less<>> shown_;
  std::vector<float> scan_;
  bool has_reported_thinning_ = false;
};

/// Returns "dtsd 0.1.0, up 3.2 s: floor streaming 100.02 Hz, lost 0".
[[nodiscard]] std::string status_line(const v1::StatusSnapshot& status);

}  // namespace dts::ctl
