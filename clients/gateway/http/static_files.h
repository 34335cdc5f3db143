// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "dts/error.h"
#include "gateway/http/http_message.h"

namespace dts::gateway {

/// The dashboard's files, all read at the start: what is not among them cannot be asked for, whatever the path looks like.
class StaticFiles {
 public:
  /// Every regular file below `root`, at most 64 MiB. Links are not followed. NotFound when there is no index.html.
  [[nodiscard]] static client::Result<StaticFiles> load(const std::filesystem::path& root);

  /// GET and HEAD. "/" is index.html; ETag and 304; names with a hash in them (assets/) may be kept for ever, index.html never unasked.
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
