// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/chair_data.h"
#include "report/page_content.h"
#include "report/session_data.h"

namespace dts::report {

/// Returns "P017, Romberg's test, 26 Nov 2026" (UTC), as far as it is known; "Quiet standing" for a file of another program.
[[nodiscard]] std::string session_title(const SessionInfo& session);
/// Returns the protocol's name for people, and its key: "Romberg's test (romberg)".
[[nodiscard]] std::string protocol_text(const SessionInfo& session);
/// Returns the condition's name for people; the key without one; "-" for no condition.
[[nodiscard]] std::string condition_text(const SessionInfo& session, const std::string& condition);
/// Returns a field about the subject with its name and unit: "Body weight", "71.5 kg".
[[nodiscard]] Fact field_fact(const SessionInfo& session, const std::string& name, const std::string& value);
/// "eyes open, feet two".
[[nodiscard]] std::string labels_text(const TrialData& trial);
/// Returns "done", or what is wrong: "redone: does not count", "done, not valid: stepped off".
[[nodiscard]] std::string outcome_text(const TrialData& trial);
/// Returns "feet=two,surface=firm" as words with places for line breaks.
[[nodiscard]] std::string stance_text(const std::string& stance);
/// Describes the filter of the analysis in words.
[[nodiscard]] std::string filter_text(const posturography::Analysis& analysis);
/// Returns the files, devices and programs from which the numbers originate, for the parts [first_part, end_part). `of_rig`: how the rig
/// computed its values.
[[nodiscard]] std::vector<Fact> provenance_of(const SessionInfo& session, std::size_t first_part, std::size_t end_part,
                                              std::vector<Fact> of_rig);
[[nodiscard]] std::vector<Fact> provenance_of(const SessionData& session, std::size_t first_part, std::size_t end_part);
/// Returns the same as a block.
[[nodiscard]] Notes provenance_notes(const std::vector<Fact>& facts);
/// Returns a paragraph for a paper: device, rate, filter, definitions, versions, and the literature to cite. `trials`: those that the page
/// is about; without an analysed one, returns nothing.
[[nodiscard]] std::optional<Notes> methods_of(const SessionData& session, std::span<const TrialData> trials);
/// Returns warnings for every page of the session: synthetic data, damaged files.
[[nodiscard]] std::vector<std::string> session_alerts(const SessionInfo& session);
[[nodiscard]] std::vector<std::string> session_alerts(const SessionData& session);
/// Returns the facts at the top of the session's page. `of_rig` follows the fields of the protocol.
[[nodiscard]] std::vector<Fact> session_facts(const SessionInfo& session, std::size_t valid_trials, const std::vector<Fact>& of_rig);
/// Lists what people corrected; empty if nothing. A deletion is not listed: a deleted session has no report.
[[nodiscard]] Notes corrections_of(const SessionInfo& session);
/// Describes how this platform differs from a metrological platform (posturography sheet section 2).
[[nodiscard]] std::string accuracy_note(const SessionData& session);

/// Returns the page of a trial.
[[nodiscard]] PageContent trial_content(const SessionData& session, const TrialData& trial);
[[nodiscard]] PageContent trial_content(const ChairData& chair, const ChairTrial& trial);
struct SessionPageLimits {
  std::size_t trials = 0;
  std::size_t pictures = 0;
};
[[nodiscard]] PageContent session_content(const SessionData& session, const SessionPageLimits& limits);
[[nodiscard]] PageContent session_content(const ChairData& chair, const SessionPageLimits& limits);

/// Returns the page as HTML that is also valid XML and complete in itself: no script, nothing to download.
[[nodiscard]] std::string html_of(const PageContent& content);
/// Returns the page as an SVG of A4 size.
[[nodiscard]] std::string svg_of(const PageContent& content);
/// Returns the pages of one document as SVGs of A4 size, for a PDF. Content that does not fit continues on a further page, so that nothing
/// is left out. Every page has `footer` and its number.
[[nodiscard]] std::vector<std::string> svg_document_of(std::span<const PageContent> contents, const std::string& footer);

}  // namespace dts::report
