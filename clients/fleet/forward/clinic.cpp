// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/clinic.h"

#include <chrono>
#include <utility>

namespace dts::fleet::forward {
namespace {

constexpr std::chrono::milliseconds kDaemonTimeout{1500};  // the program ends within 2 s

template <class Value>
core::Result<Value> converted(client::Result<Value> answer) {
  if (!answer) return tl::make_unexpected(error_of(answer.error()));
  return std::move(*answer);
}

class LocalClinic : public Clinic {
 public:
  explicit LocalClinic(client::ControlClient client) : client_(std::move(client)) {}

  core::Result<v1::ListSessionsResponse> list(std::uint32_t limit, bool deleted) override {
    v1::ListSessionsRequest request;
    request.set_limit(limit);
    request.set_deleted(deleted);
    return converted(client_.list_sessions(request));
  }
  core::Result<v1::SessionRecord> show(const std::string& session) override { return converted(client_.show_session(session)); }
  core::Result<v1::GetAuditResponse> audit(std::uint32_t limit) override { return converted(client_.audit(limit)); }

 private:
  client::ControlClient client_;
};

}  // namespace

core::Error error_of(const client::Error& error) {
  return {.code = static_cast<core::ErrorCode>(error.code), .what = error.what, .hint = error.hint};
}

core::Result<std::unique_ptr<Clinic>> open_clinic(const std::string& endpoint) {
  auto client = client::ControlClient::open({.endpoint = endpoint, .timeout = kDaemonTimeout, .tries = 1});
  if (!client) return tl::make_unexpected(error_of(client.error()));
  return std::unique_ptr<Clinic>(std::make_unique<LocalClinic>(std::move(*client)));
}

}  // namespace dts::fleet::forward
