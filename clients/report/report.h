// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::report {

/// A page: "session.html", "trial-03.svg", ...
struct Page {
  std::string file;
  std::string text;
};

/// What a report is made of.
struct ReportSource {
  std::vector<std::string> files;  ///< The parts of one session, in order; or any one recording.
  std::string software;            ///< "dtsctl 0.1.0": who computed the values.
  bool with_html = true;
  bool with_svg = true;
};

/// How far the work is, 0..1. Returns false to stop it.
using ReportProgress = std::function<bool(double)>;

struct Report {
  std::string session_id;  ///< Empty: a recording of another program.
  std::vector<Page> pages;
  std::vector<std::string> damage{};  ///< What was not whole; the pages say it too.
};

/// Stands within the first kilobyte of every page: by it a page of ours is known.
inline constexpr std::string_view kPageMark = "dtsd report page";

/// One page for the session and one for every trial of it, each as HTML and as SVG of A4 size. Everything on it is computed from the
/// recording; the same recording gives the same bytes on every machine. Fails as reading the recording does: NotFound without the stream
/// "cop" (a chair's session), DataDamaged when a closed file does not have its checksums; Failed when `progress` stops it. A torn recording
/// is reported as far as it is whole, and every page says so. Thread: any.
[[nodiscard]] core::Result<Report> make_report(const ReportSource& source, const ReportProgress& progress);

}  // namespace dts::report
