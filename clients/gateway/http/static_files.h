// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "dts/error.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// The dashboard's files, all read at the start: no path, however it is written, can request another file.
class StaticFiles {
 public:
  /// Reads every regular file below `root`, at most 64 MiB together. Does not follow links. Fails with NotFound if there is no index.html.
  [[nodiscard]] static client::Result<StaticFiles> load(const std::filesystem::path& root);

  /// Serves GET and HEAD. "/" and "/patient" are index.html. Supports ETag and 304. Browsers may cache files with a hash in their name
  /// (assets/) for ever; they must always check index.html again.
  void serve(const HttpRequest& request, const Respond& respond) const;

 private:
  struct File {
    std::string bytes;
    std::string content_type;
    std::string etag;
  };
  std::map<std::string, File> files_;  ///< By path: "/assets/index-1a2b.js"
};

}  // namespace dts::gateway
