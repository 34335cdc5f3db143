// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dts::ctl {

/// Options of the commands about sessions and their recordings.
struct SessionArguments {
  std::vector<std::string> rigs;  ///< Of a new session, the leading one first.
  std::string protocol;
  std::string subject;
  std::string label;
  std::vector<std::string> fields;  ///< KEY=VALUE
  double duration_s = 0.0;          ///< 0: until stopped.
  double settle_s = 0.0;
  std::string reason;            ///< For an abort, a correction or a deletion.
  std::string id;                ///< A session, a subject, or a file where a file is allowed.
  std::vector<std::string> ids;  ///< Sessions to compare.
  std::string action;            ///< For a trial: next, redo, reject.
  std::string language;          ///< Of a report: en, de; empty: en.
  std::string format;            ///< For an export: csv, bids, c3d, fhir.
  std::string out;               ///< File or folder; empty: the command's default.
  std::uint32_t limit = 0;       ///< For a list; 0: the daemon's default.
  bool is_deleted = false;       ///< List the deleted sessions.
};

/// Options of the commands that correct and erase.
struct EditArguments {
  std::optional<std::string> subject;  ///< Absent: stays as it is.
  std::optional<std::string> label;
  std::optional<std::string> notes;
  std::uint32_t trial = 0;
  std::uint32_t attempt = 0;  ///< 0: the newest.
  std::uint32_t part = 0;     ///< 0: the newest; with `attempt`, the only one that has it.
  std::string outcome;
  std::uint32_t marker = 0;         ///< 0: no marker.
  std::optional<std::string> text;  ///< Of the marker.
  bool is_removal = false;          ///< Remove the text of the marker.
  bool is_confirmed = false;        ///< `--yes`
};

/// Options of the commands about the visits of a subject.
struct SubjectArguments {
  std::string measure;  ///< "MVELO"; empty: the usual ones.
  std::string language = "en";
  std::string added;          ///< Text of a note, or protocol of a planned session; empty: nothing is added.
  std::string due_date;       ///< Of the planned session; empty: none.
  std::uint32_t removed = 0;  ///< Number of a note or a planned session; 0: nothing is removed.
};

}  // namespace dts::ctl
