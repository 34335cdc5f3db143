// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include "report/page_parts.h"
#include "report/session_data.h"
#include "report/translation.h"

namespace dts::report {
namespace {

constexpr double kAnalysedShare = 0.9;
constexpr SessionPageLimits kHtmlLimits{.trials = 10'000, .pictures = 60};
constexpr SessionPageLimits kSvgLimits{.trials = 24, .pictures = 14};  // limits of an A4 page

void add(const ReportSource& source, const std::string& name, const PageContent& content, Report& report) {
  if (source.with_html) report.pages.push_back({.file = name + ".html", .text = html_of(content)});
  if (source.with_svg) report.pages.push_back({.file = name + ".svg", .text = svg_of(content)});
}

}  // namespace

core::Result<Report> make_report(const ReportSource& source, const ReportProgress& progress) {
  DTS_TRY_ASSIGN(auto session, read_session(source, progress));
  const Translation translated(source.language, session.protocol);
  Report report{.session_id = session.session_id(), .pages = {}};
  for (const PartData& part : session.parts) {
    if (!part.damage.empty()) report.damage.push_back(part.file + ": " + part.damage + "; only the undamaged part is reported");
  }
  if (source.with_html)
    report.pages.push_back({.file = "session.html", .text = html_of(translated(session_content(session, kHtmlLimits)))});
  if (source.with_svg) report.pages.push_back({.file = "session.svg", .text = svg_of(translated(session_content(session, kSvgLimits)))});
  for (std::size_t index = 0; index < session.trials.size(); ++index) {
    const double done = static_cast<double>(index) / static_cast<double>(session.trials.size());
    if (!progress(kAnalysedShare + (1.0 - kAnalysedShare) * done)) {
      return core::fail(core::ErrorCode::Failed, "the report was interrupted: no page was written");
    }
    add(source, session.trials[index].page, translated(trial_content(session, session.trials[index])), report);
  }
  return report;
}

}  // namespace dts::report
