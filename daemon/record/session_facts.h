// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dts::record {

inline constexpr int kFormatVersion = 1;  ///< Of the facts and events below, not of XDF.

/// Everything about a recording that is known before its first scan (design section 7). Stands in the file's header, so that the
/// catalogue can be rebuilt from the files and a replay needs nothing else. Nothing in it names a person.
struct SessionFacts {
  std::string session_id;  ///< "20261121T144525Z-floor-1"
  std::uint32_t part = 1;  ///< Counts up when an interrupted session is resumed.
  std::string rig;
  std::string kind;      ///< "floor"
  std::string protocol;  ///< "free"
  std::string subject;   ///< Pseudonym given by the clinic; may be empty.
  std::string label;
  std::vector<std::pair<std::string, std::string>> fields{};  ///< What the protocol asks about the subject: {"arm_length_cm", "71"}.
  std::int64_t started_utc_ns = 0;
  std::int64_t utc_minus_monotonic_ns = 0;  ///< At the start: maps time stamps (CLOCK_MONOTONIC, s) to UTC.
  std::string boot_id;                      ///< Time stamps of different boots do not compare.
  std::string software;                     ///< "dtsd 0.1.0"
  std::string device_uri;
  std::string device_model;
  std::string device_serial;
  std::string firmware;
  std::string calibration_id;         ///< Of the centre of pressure; empty: the plate model stands in for it.
  std::vector<std::string> stages{};  ///< "window_filter window_scans=3 shift_scans=1", in order
  std::string rig_definition;         ///< The rig file with all it refers to, as one TOML text.
  std::string protocol_definition;    ///< The protocol's TOML text.
  std::uint64_t plan_seed = 0;        ///< Of the trials' order.
  double duration_s = 0.0;            ///< As asked for at the start; 0: as the protocol says.
  double settle_s = 0.0;              ///< Likewise.
  std::string model_sha256;           ///< Of the classifier; empty: none.

  friend bool operator==(const SessionFacts&, const SessionFacts&) = default;
};

/// As pairs for a file header, and back. Reading fails with DataDamaged, naming the fact, when a number is none, a text is longer than
/// 1 MiB or the format version is unknown; facts of other programs are ignored.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> to_facts(const SessionFacts& session);
[[nodiscard]] core::Result<SessionFacts> session_facts(const std::vector<std::pair<std::string, std::string>>& facts);

}  // namespace dts::record
