// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "report/language.h"

namespace dts::report {

/// A page: "session.html", "trial-03.svg", ...
struct Page {
  std::string file;
  std::string text;
};

/// Input of a report.
struct ReportSource {
  std::vector<std::string> files;  ///< The parts of one session, in order; or one recording. Parts of companions are left out.
  std::string software;            ///< "dtsctl 0.1.0": the program that computed the values.
  bool with_html = true;
  bool with_svg = true;
  Language language = Language::English;  ///< Of all pages; the figures are the same.
};

/// Receives the progress, 0..1. Returns false to stop the report.
using ReportProgress = std::function<bool(double)>;

struct Report {
  std::string session_id;  ///< Empty: a recording by another program.
  std::vector<Page> pages;
  std::vector<std::string> damage{};  ///< What was damaged; the pages also show it.
};

/// Is in the first kilobyte of every page, so that our own pages can be recognised.
inline constexpr std::string_view kPageMark = "dtsd report page";

/// Creates one page for the session and one for each of its trials, each as HTML and as SVG of A4 size. All content is computed from the
/// recording; the same recording gives the same bytes on every machine. Fails as reading the recording fails: with NotFound without the
/// stream "cop" (a chair's session), with DataDamaged if a closed file does not match its checksums. Fails with Failed if `progress` stops
/// it. Reports a torn recording up to the damage, and every page states that. Thread: any.
[[nodiscard]] core::Result<Report> make_report(const ReportSource& source, const ReportProgress& progress);

}  // namespace dts::report
