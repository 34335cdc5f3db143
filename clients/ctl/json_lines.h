// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "ctl/watch_sink.h"

namespace dts::ctl {

/// Prints one JSON object per block or event, and flushes each complete line at once: a reader never waits for the rest of an object.
///
///     {"topic":"floor/cop","rig":"floor","stream":"cop","segment":1,"first_scan":0,"rate_hz":100,"host_time_ns":...,
///      "instance_id":...,"sequence":1,"lost_scans":0,"age_ms":0.4,"quality":{"ml_mm":["no_contact"]},
///      "channels":["ml_mm","ap_mm","load_n"],"units":["mm","mm","N"],"values":[[null,null,0.5],...]}
///
/// Numbers have the fewest digits that convert back to the same 32-bit float; undefined values are null. `quality` lists only channels with
/// quality bits, `age_ms` is absent if unknown, `instance_id` changes when the daemon restarts, and "lost_scans_at_least":true means that
/// more scans may be missing.
class JsonLines final : public WatchSink {
 public:
  explicit JsonLines(std::ostream& out) : out_(out) {}

  void show(const client::Block& block, std::size_t scans, Time now) override;
  void show(const client::Event& event) override;
  void show(const client::Status& status) override;
  void forget() override { fixed_.clear(); }
  void refresh(Time /*now*/) override {}

 private:
  /// The constant parts of a stream's lines, made only once, because JSON text is the most expensive part of this class.
  struct Fixed {
    std::string head;      ///< {"topic":...,"rig":...,"stream":...
    std::string channels;  ///< ,"channels":[...],"units":[...]
  };
  const Fixed& fixed_of(const client::Block& block);
  void write();

  std::ostream& out_;
  std::string line_;
  std::map<std::string, Fixed, std::less<>> fixed_;
};

}  // namespace dts::ctl
