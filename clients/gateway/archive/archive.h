// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "dts/error.h"
#include "gateway/access/identity.h"
#include "gateway/http/http_message.h"
#include "report/report.h"

namespace dts::gateway {

/// Requests a session from the daemon's catalogue; answers on the io thread.
using FindSession = std::function<void(const std::string& session_id, std::function<void(client::Result<v1::SessionRecord>)>)>;

struct ArchiveOptions {
  std::filesystem::path cache_directory;  ///< Exports are stored in "dts-gateway-exports" inside: emptied at the start, bounded.
  std::uint64_t cache_bytes = 2ULL << 30U;
  std::chrono::seconds pdf_limit = report::kLongestPdf;  ///< A PDF that takes longer fails.
};

/// Finished sessions as files: report pages (the bytes of `dtsctl report`), recordings and exports. Threads of their own make them from the
/// recording: one makes pages, one makes tables (CSV, BIDS, C3D), two make PDFs and FHIR Bundles, which contain one. The results are cached
/// for a while.
///
///     GET /api/sessions/ID/report             {"pages":["session.html","trial-01.html",...],"damage":[...]}
///     GET /api/sessions/ID/report/PAGE        the page, html or svg, with a Content-Security-Policy of its own
///     GET /api/sessions/ID/report/report.pdf  the session's page and the pages of its trials as PDF; HEAD returns its size
///     GET /api/sessions/ID/export/xdf/PART    the recording, unchanged
///     GET /api/sessions/ID/export/csv|bids|c3d|fhir    a zip file; HEAD returns its size
///
/// Errors are JSON: {"what","hint"}. Thread: io.
class Archive {
 public:
  [[nodiscard]] static client::Result<std::unique_ptr<Archive>> open(boost::asio::io_context& io, const ArchiveOptions& options,
                                                                     FindSession find_session);
  virtual ~Archive() = default;
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  /// Handles a path below /api/sessions/; the caller has checked that the user may view.
  virtual void handle(HttpRequest request, Respond respond) = 0;
  /// Removes all cached reports and exports, and does not keep what is being made now: a subject was erased.
  virtual void forget() = 0;

 protected:
  Archive() = default;
};

}  // namespace dts::gateway
