// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "record/session_facts.h"

namespace dts::record {

/// What a correction changes. `Deleted` has the values "no" and "yes".
enum class CorrectedField : std::uint8_t { Subject = 1, Label, Notes, Outcome, Deleted, Marker };
/// Returns "subject", "label", "notes", "outcome", "deleted" or "marker".
[[nodiscard]] std::string_view name(CorrectedField field) noexcept;

/// Returns true for a free text of people.
[[nodiscard]] bool is_text(CorrectedField field) noexcept;

/// How an attempt of a trial can have ended.
inline constexpr std::array<std::string_view, 4> kTrialOutcomes{"done", "redone", "rejected", "aborted"};

/// Stands for a text that a person has removed: perhaps it had a name. Only the recording still has such a label or marker.
inline constexpr std::string_view kRemovedText = "[removed]";

/// Stands for an erased subject ID.
inline constexpr std::string_view kErasedText = "[erased]";

/// A change of a closed session by a person. The recording stays as it is.
struct Correction {
  std::uint32_t number = 1;  ///< Counts from 1 without missing numbers.
  std::int64_t utc_ns = 0;
  std::string who;  ///< As in an audit entry.
  CorrectedField field = CorrectedField::Subject;
  std::uint32_t part = 0;   ///< Of an outcome or a marker; else 0.
  std::uint32_t trial = 0;  ///< Of an outcome, as the next one; else 0.
  std::uint32_t attempt = 0;
  std::uint32_t marker = 0;  ///< Number of the marker in the recording of this part, from 1; else 0.
  std::string old_value;
  std::string new_value;
  std::string reason;

  friend bool operator==(const Correction&, const Correction&) = default;
};

inline constexpr std::size_t kMostCorrections = 1000;        ///< Of one session. Removals and deletions are possible beyond it.
inline constexpr std::size_t kMostListed = 2000;             ///< Of one session, with these.
inline constexpr std::size_t kLongestCorrectionText = 4096;  ///< Bytes of a value or a reason in a file.

/// All corrections of a session, oldest first. They are in a file beside the recordings, "SESSION.corrections.json", so that they survive
/// the loss of the catalogue and move with the recordings. The catalogue has a copy for its queries.
struct Corrections {
  std::string session_id;
  std::vector<Correction> all{};

  /// Returns the newest value of a field; nullptr if it was not corrected.
  [[nodiscard]] const std::string* value(CorrectedField field) const;
  /// Returns the newest outcome of an attempt; nullptr if it was not corrected.
  [[nodiscard]] const std::string* outcome(std::uint32_t part, std::uint32_t trial, std::uint32_t attempt) const;

  /// Returns the newest text of a marker; nullptr if it was not corrected.
  [[nodiscard]] const std::string* marker(std::uint32_t part, std::uint32_t number) const;
  /// Returns whether a person has removed the text of a marker.
  [[nodiscard]] bool has_removed_marker(std::uint32_t part, std::uint32_t number) const;

  /// Returns whether a person has removed this text, which then must not be repeated. Another text may have followed.
  [[nodiscard]] bool has_removed(CorrectedField field) const;

  /// Adds a correction with the next number. If it removes a text, its earlier values become `kRemovedText`.
  void add(Correction correction);

  friend bool operator==(const Corrections&, const Corrections&) = default;
};

inline constexpr std::string_view kCorrectionsEnding = ".corrections.json";

/// Returns the name of the session's file in the folder of this recording.
[[nodiscard]] std::string corrections_file(const std::string& recording, const std::string& session_id);
/// Fails with NotFound without a file, and with DataDamaged, naming the file, if it is no list of corrections. Thread: any.
[[nodiscard]] core::Result<Corrections> read_corrections(const std::string& file);
/// Returns the corrections beside a recording; none without a file. Fails with DataDamaged. Thread: any.
[[nodiscard]] core::Result<Corrections> corrections_beside(const std::string& recording, const SessionFacts& facts);
/// Replaces the file as a whole: after a power failure it has the old or the new content. Its data are on the disk when this returns.
[[nodiscard]] core::Status write_corrections(const std::string& file, const Corrections& corrections);

/// Returns the facts with the corrected subject ID and label.
[[nodiscard]] SessionFacts corrected(SessionFacts facts, const Corrections& corrections);

}  // namespace dts::record
