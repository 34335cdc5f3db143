// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/corrections.h"
#include "record/recording.h"
#include "record/session_facts.h"
#include "report/report.h"
#include "session/protocol.h"

namespace dts::report {

/// One file of the session.
struct PartData {
  std::string file;      ///< Without its folder, so that reports are the same on every machine.
  std::string sha256{};  ///< Empty: the file is damaged.
  std::string state{};   ///< In the words of the catalogue; empty if the file is damaged.
  std::string damage;    ///< Empty: no damage.
  std::string losses;    ///< What is missing between its first and its last scan; empty: nothing.
};

/// What the pages of every kind of rig show of a session.
struct SessionInfo {
  std::string software;
  std::optional<record::SessionFacts> facts;  ///< Of the first part, with corrected values; absent: a file of another program.
  record::Corrections corrections;            ///< Of the session.
  std::vector<PartData> parts;
  session::Protocol protocol{};  ///< As recorded, for names.
  std::uint32_t planned_trials = 0;
  bool for_record = false;  ///< As `ReportSource::for_record`.

  [[nodiscard]] std::string session_id() const { return facts ? facts->session_id : ""; }
  [[nodiscard]] bool is_synthetic() const { return facts && facts->device_uri.starts_with("sim:"); }
  /// A recording was played on the rig: nobody was measured in this session.
  [[nodiscard]] bool is_replayed() const { return facts && facts->device_uri.starts_with("replay:"); }
};

/// The range [begin, end) of the progress for one piece of work.
struct Share {
  double begin = 0.0;
  double end = 1.0;
};

/// Remembers that the report was stopped, because the callbacks of the readers cannot.
class Waiting {
 public:
  Waiting(const ReportProgress& progress) : progress_(progress) {}
  void report(const Share& share, double fraction);
  [[nodiscard]] bool is_wanted() const noexcept { return is_wanted_; }

 private:
  const ReportProgress& progress_;
  bool is_wanted_ = true;
};

/// Returns the error of a report that was stopped.
[[nodiscard]] tl::unexpected<core::Error> interrupted();

/// Opens the next file of the session, notes it in `session.parts`, and with the first file the facts and the protocol. Fails with
/// DataDamaged if a closed file does not match its checksums.
[[nodiscard]] core::Result<std::unique_ptr<record::Recording>> open_part(const std::string& path, Waiting& waiting, const Share& share,
                                                                         SessionInfo& session);
/// Returns the files of the rig that leads the session: the trials and results are those of its recordings. Files of companions alone stay.
[[nodiscard]] std::vector<std::string> leading_files(const std::vector<std::string>& files);
/// Converts host time to UTC; nothing if one of them is unknown.
[[nodiscard]] std::optional<std::int64_t> utc_of(const std::optional<std::int64_t>& host_ns,
                                                 const std::optional<record::SessionFacts>& facts);
/// Returns whether two values are equal except for rounding: 1e-9 relative.
[[nodiscard]] bool is_same_value(double a, double b) noexcept;

}  // namespace dts::report
