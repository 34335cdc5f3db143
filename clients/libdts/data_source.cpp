// SPDX-License-Identifier: Apache-2.0
#include "data_source.h"

#include "ipc_source.h"
#include "zmq_source.h"

namespace dts::client {

Result<std::unique_ptr<DataSource>> open_source(const SourceOptions& options) {
  if (options.endpoint.starts_with("ipc://")) {
    auto source = IpcSource::open(options);
    if (!source) return tl::make_unexpected(source.error());
    return std::move(*source);
  }
  try {
    return std::make_unique<ZmqSource>(options);
  } catch (const zmq::error_t& error) {
    return fail(ErrorCode::InvalidArgument, "cannot use the data address '" + options.endpoint + "': " + error.what());
  }
}

}  // namespace dts::client
