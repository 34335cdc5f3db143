// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/login_request.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace dts::gateway {

client::Result<LoginRequest> read_login(std::string& body) {
  auto document = nlohmann::json::parse(body, nullptr, false);
  wipe(body);
  const auto is_text = [&document](const char* name) { return document.contains(name) && document[name].is_string(); };
  if (!document.is_object() || document.size() != 2 || !is_text("user") || !is_text("password")) {
    return client::fail(client::ErrorCode::InvalidArgument, R"(a login must have the form {"user": "...", "password": "..."})");
  }
  return LoginRequest{.user = document["user"].get<std::string>(),
                      .password = Secret(std::move(document["password"].get_ref<std::string&>()))};
}

}  // namespace dts::gateway
