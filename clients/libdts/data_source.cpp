// SPDX-License-Identifier: Apache-2.0
#include "data_source.h"

#include "ipc_source.h"
#include "try.h"
#include "zmq_source.h"

namespace dts::client {

Result<std::unique_ptr<DataSource>> open_source(const SourceOptions& options) {
  if (options.endpoint.starts_with("ipc://")) {
    DTS_TRY_ASSIGN(auto source, IpcSource::open(options));
    return source;
  }
  try {
    return std::make_unique<ZmqSource>(options);
  } catch (const zmq::error_t& error) {
    return fail(ErrorCode::InvalidArgument, "cannot use the data address '" + options.endpoint + "': " + error.what());
  }
}

}  // namespace dts::client
