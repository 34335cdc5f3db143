// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "dts/error.h"
#include "gateway/access/identity.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// Asks the daemon for a session of its catalogue; answers on the io thread.
using FindSession = std::function<void(const std::string& session_id, std::function<void(client::Result<v1::SessionRecord>)>)>;

struct ArchiveOptions {
  std::filesystem::path cache_directory;  ///< What is made lies in "dts-gateway-exports" within: emptied at the start, bounded.
  std::uint64_t cache_bytes = 2ULL << 30U;
};

/// Finished sessions as files: report pages (the bytes of `dtsctl report`), recordings and exports. Made on a thread of its own, one at
/// a time, from the recording; what was made is kept for a while.
///
///     GET /api/sessions/ID/report             {"pages":["session.html","trial-01.html",...],"damage":[...]}
///     GET /api/sessions/ID/report/PAGE        the page, html or svg, with a Content-Security-Policy of its own
///     GET /api/sessions/ID/export/xdf/PART    the recording as it lies on the disk
///     GET /api/sessions/ID/export/csv|bids    a zip file; HEAD tells its size
///
/// Errors are JSON: {"what","hint"}. Thread: io.
class Archive {
 public:
  [[nodiscard]] static client::Result<std::unique_ptr<Archive>> open(boost::asio::io_context& io, const ArchiveOptions& options,
                                                                     FindSession find_session);
  virtual ~Archive() = default;
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  /// A path below /api/sessions/, of somebody who may view.
  virtual void handle(HttpRequest request, Respond respond) = 0;

 protected:
  Archive() = default;
};

}  // namespace dts::gateway
