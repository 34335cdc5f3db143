// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "report/language.h"
#include "report/pdf.h"

namespace dts::report {

/// A page: "session.html", "trial-03.svg", ..., or the document "report.pdf".
struct Page {
  std::string file;
  std::string text;
};

inline constexpr std::string_view kPdfName = "report.pdf";

/// Input of a report.
struct ReportSource {
  std::vector<std::string> files;  ///< The parts of one session, in order; or one recording. Parts of companions are left out.
  std::string software;            ///< "dtsctl 0.1.0": the program that computed the values.
  bool with_html = true;
  bool with_svg = true;
  bool with_pdf = false;                         ///< "report.pdf": the session's page and the pages of its trials in one document.
  std::chrono::seconds pdf_limit = kLongestPdf;  ///< For rsvg-convert.
  Language language = Language::English;         ///< Of all pages; the figures are the same.
  /// For a person's record outside the clinic's own recordings: no label, notes, corrections with their authors, or values before them.
  bool for_record = false;
};

/// Receives the progress, 0..1. Returns false to stop the report.
using ReportProgress = std::function<bool(double)>;

struct Report {
  std::string session_id;  ///< Empty: a recording by another program.
  std::vector<Page> pages;
  std::vector<std::string> damage{};  ///< What was damaged; the pages also show it.
};

/// Is in the first kilobyte of every page, and in the last kilobyte of a PDF, so that our own pages can be recognised.
inline constexpr std::string_view kPageMark = "dtsd report page";

/// Creates one page for the session and one for each of its trials, each as HTML and as SVG of A4 size. All content is computed from the
/// recording; the same recording gives the same bytes on every machine. Fails as reading the recording fails: with NotFound without the
/// stream "cop" (a chair's session), with DataDamaged if a closed file does not match its checksums. Fails with Failed if `progress` stops
/// it. Reports a torn recording up to the damage, and every page states that. Thread: any.
[[nodiscard]] core::Result<Report> make_report(const ReportSource& source, const ReportProgress& progress);

/// Returns the session's page as a PDF document, without the pages of its trials, for other documents that contain it. `with_html`,
/// `with_svg` and `with_pdf` of the source do not matter. The same recording gives the same bytes with the same version of rsvg-convert and
/// the same fonts. Fails as `make_report`, and with Unsupported if rsvg-convert is not installed (see pdf.h). Thread: any.
[[nodiscard]] core::Result<std::string> make_session_pdf(const ReportSource& source, const ReportProgress& progress);

}  // namespace dts::report
