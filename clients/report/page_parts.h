// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "report/page_content.h"
#include "report/session_data.h"

namespace dts::report {

/// "eyes open, feet two".
[[nodiscard]] std::string labels_text(const TrialData& trial);
/// "done", or loud: "REDONE: does not count".
[[nodiscard]] std::string outcome_text(const TrialData& trial);
/// What the filter of the analysis is, in words.
[[nodiscard]] std::string filter_text(const posturography::Analysis& analysis);
/// Files, devices, programs: where the numbers come from. `part`: of which file; all of them when it is none.
[[nodiscard]] std::vector<Fact> provenance_of(const SessionData& session, std::size_t first_part, std::size_t end_part);
/// True of every page of the session: synthetic data, damaged files.
[[nodiscard]] std::vector<std::string> session_alerts(const SessionData& session);
/// How far from a metrological platform this one is (posturography sheet section 2).
[[nodiscard]] std::string accuracy_note(const SessionData& session);

/// One page of a trial, one of the session. `most_cells`: stabilograms that fit, of more the page tells.
[[nodiscard]] PageContent trial_content(const SessionData& session, const TrialData& trial);
struct SessionPageLimits {
  std::size_t trials = 0;
  std::size_t pictures = 0;
};
[[nodiscard]] PageContent session_content(const SessionData& session, const SessionPageLimits& limits);

/// The page as HTML that is also XML, with everything in it: no script, nothing to fetch.
[[nodiscard]] std::string html_of(const PageContent& content);
/// The page as an SVG of A4 size.
[[nodiscard]] std::string svg_of(const PageContent& content);

}  // namespace dts::report
