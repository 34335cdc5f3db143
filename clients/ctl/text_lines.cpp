// SPDX-License-Identifier: Apache-2.0
#include "ctl/text_lines.h"

#include "cli/table.h"
#include "ctl/json.h"
#include "ctl/reading.h"

namespace dts::ctl {
namespace {

constexpr std::chrono::milliseconds kPause{100};

}  // namespace

void TextLines::show(const client::Block& block, std::size_t scans, Time now) {
  const auto known = shown_.find(block.topic);
  const bool is_new = known == shown_.end();
  Shown& shown = is_new ? shown_[std::string(block.topic)] : known->second;
  shown.unsaid_lost_scans += block.lost_scans;
  if (!has_reported_thinning_ && (scans > 1 || (!is_new && now - shown.at < kPause))) {
    has_reported_thinning_ = true;
    console_.talk << console_.program << ": this view shows at most 10 scans per second of each stream; --jsonl shows all" << std::endl;
  }
  if (!is_new && now - shown.at < kPause) return;
  shown.at = now;
  copy_scan(block, scans - 1, scan_);
  console_.out << cli::printable(block.topic) << "  scan " << block.first_scan + scans - 1 << "  "
               << reading(*block.format, scan_, block.quality);
  if (shown.unsaid_lost_scans > 0) console_.out << "  (missed " << shown.unsaid_lost_scans << " scans)";
  shown.unsaid_lost_scans = 0;
  console_.out << std::endl;
}

void TextLines::show(const client::Event& event) {
  console_.out << cli::printable(event.rig) << "  scan " << event.body->scan() << "  " << event_line(event) << std::endl;
}

void TextLines::show(const client::Status& status) { console_.out << status_line(*status.snapshot) << std::endl; }

std::string status_line(const v1::StatusSnapshot& status) {
  std::string line = "dtsd " + status.version() + ", up " + cli::duration(status.uptime_s());
  for (const v1::RigStatus& rig : status.rigs()) {
    line += (line.find(':') == std::string::npos ? ": " : "; ") + rig.rig().name() + " " +
            enumerator_word(*v1::DeviceState_descriptor(), rig.device()) + " " +
            (rig.measured_rate_hz() > 0.0 ? cli::decimal(rig.measured_rate_hz(), 2) : "-") + " Hz, lost " +
            std::to_string(rig.lost_scans_total());
  }
  return cli::printable(line);
}

}  // namespace dts::ctl
