// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dts::record {

inline constexpr int kFormatVersion = 1;  ///< Version of our facts and events, not of XDF.

/// Returns whether a text is empty or only has letters, digits, '_', '.' and '-', as session IDs and subject IDs have.
[[nodiscard]] bool is_id(std::string_view text) noexcept;
inline constexpr std::size_t kLongestSubject = 64;

/// Everything about a recording that is known before its first scan (design section 7). The file header holds it, so that the catalogue
/// can be rebuilt from the files and a replay needs no other file. It contains no name of a person.
struct SessionFacts {
  std::string session_id;  ///< "20261121T144525Z-floor-1"
  std::uint32_t part = 1;  ///< Unique in the session. Rises with each rig, and each time that an interrupted session is resumed.
  std::string rig;
  std::vector<std::string> rigs{};  ///< Of a session over several rigs, the leading one first; empty: one rig.
  std::uint32_t leading_part = 0;   ///< Of a companion: part of the leading rig that was recorded at the same time; 0: this part leads.
  std::string kind;                 ///< "floor"
  std::string protocol;             ///< "free"
  std::string subject;              ///< Subject ID that the clinic assigned; may be empty.
  std::string label;
  std::vector<std::pair<std::string, std::string>> fields{};  ///< The protocol's fields about the subject: {"arm_length_cm", "71"}.
  std::int64_t started_utc_ns = 0;
  std::int64_t utc_minus_monotonic_ns = 0;  ///< At the start: maps time stamps (CLOCK_MONOTONIC, s) to UTC.
  std::string boot_id;                      ///< Time stamps of different boots cannot be compared.
  std::string software;                     ///< "dtsd 0.1.0"
  std::string device_uri;
  std::string device_model;
  std::string device_serial;
  std::string firmware;
  std::string calibration_id;         ///< Of the centre of pressure; empty: the plate model is used instead.
  std::vector<std::string> stages{};  ///< "window_filter window_scans=3 shift_scans=1", in order
  std::string rig_definition;         ///< The rig file and all files that it names, as one TOML text.
  std::string protocol_definition;    ///< The protocol's TOML text.
  std::uint64_t plan_seed = 0;        ///< Seed of the random order of trials.
  double duration_s = 0.0;            ///< Requested at the start; 0: the protocol's value.
  double settle_s = 0.0;              ///< Requested at the start; 0: the protocol's value.
  std::string model_sha256;           ///< Of the classifier; empty: none.

  friend bool operator==(const SessionFacts&, const SessionFacts&) = default;
};

/// Returns the rig that leads the session: its trials and results are those of the session.
[[nodiscard]] const std::string& leading_rig(const SessionFacts& facts) noexcept;
/// Returns the number of the part that has the session's trials of the same time: this part, or that of the leading rig.
[[nodiscard]] std::uint32_t leading_part(const SessionFacts& facts) noexcept;

/// Returns the facts as pairs for a file header.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> to_facts(const SessionFacts& session);
/// Reads the pairs of a file header; ignores facts of other programs. Fails with DataDamaged, naming the fact, if a number is invalid, a
/// text is longer than 1 MiB or the format version is unknown.
[[nodiscard]] core::Result<SessionFacts> session_facts(const std::vector<std::pair<std::string, std::string>>& facts);

}  // namespace dts::record
