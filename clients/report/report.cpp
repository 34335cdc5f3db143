// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include <algorithm>
#include <span>

#include "record/recording.h"
#include "report/chair_data.h"
#include "report/page_parts.h"
#include "report/pdf.h"
#include "report/session_data.h"
#include "report/translation.h"

namespace dts::report {
namespace {

constexpr double kAnalysedShare = 0.9;
constexpr SessionPageLimits kHtmlLimits{.trials = 10'000, .pictures = 60};
constexpr SessionPageLimits kSvgLimits{.trials = 24, .pictures = 14};      // limits of an A4 page
constexpr SessionPageLimits kPdfLimits{.trials = 10'000, .pictures = 49};  // one picture of all trials must fit on an A4 page
constexpr std::size_t kMostPdfTrials = 150;

/// Renders pages; the document ends with the mark of our pages, as a comment.
template <class Data>
core::Result<std::string> pdf_with_mark(const Data& session, std::span<const PageContent> contents, const ReportSource& source,
                                        const ReportProgress& progress) {
  const std::int64_t created_utc_s = session.facts ? session.facts->started_utc_ns / 1'000'000'000 : 0;
  const std::string footer = session.facts ? session.session_id() + ", " + session.software : session.software;
  DTS_TRY_ASSIGN(auto document,
                 pdf_of(
                     svg_document_of(contents, footer), created_utc_s, [&progress] { return progress(kAnalysedShare); }, source.pdf_limit));
  return document + "%" + std::string(kPageMark) + "\n";
}

template <class Data>
core::Result<std::string> whole_pdf(const Data& session, const Translation& translated, const ReportSource& source,
                                    const ReportProgress& progress) {
  std::vector<PageContent> contents{session_content(session, kPdfLimits)};
  const std::size_t trials = std::min(session.trials.size(), kMostPdfTrials);
  if (trials < session.trials.size()) {
    contents.front().alerts.push_back("This PDF has the pages of the first " + std::to_string(trials) + " of " +
                                      std::to_string(session.trials.size()) + " trials. The HTML report has all pages.");
  }
  for (std::size_t index = 0; index < trials; ++index) contents.push_back(trial_content(session, session.trials[index]));
  for (PageContent& content : contents) content = translated(std::move(content));
  return pdf_with_mark(session, contents, source, progress);
}

template <class Data>
core::Result<Report> pages_of(const Data& session, const ReportSource& source, const ReportProgress& progress) {
  const Translation translated(source.language, session.protocol);
  Report report{.session_id = session.session_id(), .pages = {}};
  for (const PartData& part : session.parts) {
    if (!part.damage.empty()) report.damage.push_back(part.file + ": " + part.damage + "; only the undamaged part is reported");
  }
  if (source.with_html)
    report.pages.push_back({.file = "session.html", .text = html_of(translated(session_content(session, kHtmlLimits)))});
  if (source.with_svg) report.pages.push_back({.file = "session.svg", .text = svg_of(translated(session_content(session, kSvgLimits)))});
  for (std::size_t index = 0; index < session.trials.size() && (source.with_html || source.with_svg); ++index) {
    const double done = static_cast<double>(index) / static_cast<double>(session.trials.size());
    if (!progress(kAnalysedShare + (1.0 - kAnalysedShare) * done)) return interrupted();
    const std::string& name = session.trials[index].page;
    const PageContent content = translated(trial_content(session, session.trials[index]));
    if (source.with_html) report.pages.push_back({.file = name + ".html", .text = html_of(content)});
    if (source.with_svg) report.pages.push_back({.file = name + ".svg", .text = svg_of(content)});
  }
  if (source.with_pdf) {
    DTS_TRY_ASSIGN(auto document, whole_pdf(session, translated, source, progress));
    report.pages.push_back({.file = std::string(kPdfName), .text = std::move(document)});
  }
  return report;
}

/// Reads the session of the rig's kind and passes it to `make`.
template <class Made, class Make>
core::Result<Made> with_session(const ReportSource& source, const ReportProgress& progress, const Make& make) {
  if (source.files.empty()) return core::fail(core::ErrorCode::InvalidArgument, "no recording for the report");
  const auto facts = record::read_session_facts(leading_files(source.files).front());
  if (facts && facts->kind == "chair") {
    DTS_TRY_ASSIGN(const auto chair, read_chair_session(source, progress));
    return make(chair);
  }
  DTS_TRY_ASSIGN(const auto session, read_session(source, progress));
  return make(session);
}

}  // namespace

core::Result<Report> make_report(const ReportSource& source, const ReportProgress& progress) {
  return with_session<Report>(source, progress, [&](const auto& session) { return pages_of(session, source, progress); });
}

core::Result<std::string> make_session_pdf(const ReportSource& source, const ReportProgress& progress) {
  return with_session<std::string>(source, progress, [&](const auto& session) {
    const Translation translated(source.language, session.protocol);
    const std::vector<PageContent> contents{translated(session_content(session, kPdfLimits))};
    return pdf_with_mark(session, contents, source, progress);
  });
}

}  // namespace dts::report
