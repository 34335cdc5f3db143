// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/console.h"
#include "ctl/watch_sink.h"

namespace dts::ctl {

/// Prints one stream as CSV: a line of names, then a line per scan; undefined values are empty. Omits events. For a second stream it prints
/// once that the stream is omitted.
///
///     segment,scan,ml_mm,ap_mm,load_n
///     1,1036,-1.7779222,3.3133867,585.61926
class CsvLines final : public WatchSink {
 public:
  explicit CsvLines(cli::Console& console) : console_(console) {}

  void show(const client::Block& block, std::size_t scans, Time now) override;
  void show(const client::Event& /*event*/) override {}
  void show(const client::Status& /*status*/) override {}
  [[nodiscard]] bool shows(std::string_view topic) const override { return topic == topic_; }
  void forget() override {}
  void refresh(Time /*now*/) override {}

 private:
  void begin(const client::Block& block);

  cli::Console& console_;
  std::string topic_;  ///< Topic of the first block.
  std::string text_;
  bool has_reported_other_ = false;
};

}  // namespace dts::ctl
