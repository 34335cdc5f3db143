// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "ctl/watch_sink.h"

namespace dts::ctl {

/// One JSON object per block or event, each line flushed when it is complete: a reader never sees half an object late.
///
///     {"topic":"floor/cop","rig":"floor","stream":"cop","segment":1,"first_scan":0,"rate_hz":100,"host_time_ns":...,
///      "sequence":1,"lost_scans":0,"age_ms":0.4,"quality":{"ml_mm":["no_contact"]},
///      "channels":["ml_mm","ap_mm","load_n"],"units":["mm","mm","N"],"values":[[null,null,0.5],...]}
///
/// Numbers have the fewest digits that give the same 32-bit float back; undefined values are null. `quality` names the
/// channels in doubt only, `age_ms` is absent when unknown, and "lost_scans_at_least":true says that more may be missing.
class JsonLines final : public WatchSink {
 public:
  explicit JsonLines(std::ostream& out) : out_(out) {}

  void show(const client::Block& block, std::size_t scans, Time now) override;
  void show(const client::Event& event) override;
  void show(const client::Status& status) override;
  void forget() override { fixed_.clear(); }
  void refresh(Time /*now*/) override {}

 private:
  /// The parts of a stream's lines that never change, made once: JSON text costs more than everything else here.
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
