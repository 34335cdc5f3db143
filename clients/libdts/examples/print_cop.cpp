// SPDX-License-Identifier: Apache-2.0
// Prints the centre of pressure of the rig "floor" while a daemon runs.
#include <dts/endpoints.h>
#include <dts/subscriber.h>

#include <chrono>
#include <iostream>
#include <variant>

int main() {
  const auto where = dts::client::find_endpoints();
  if (!where) return 1;
  auto subscriber = dts::client::Subscriber::open({.endpoint = where->data, .topics = {"floor/cop"}});
  while (subscriber) {
    const auto message = subscriber->receive(std::chrono::seconds(5));
    if (!message || !*message) return 1;  // the socket failed, or no message arrived
    const auto* block = std::get_if<dts::client::Block>(&**message);
    if (block == nullptr) continue;
    std::cout << "scan " << block->first_scan << ": right " << block->column(0)[0] << " mm" << std::endl;
  }
}
