// SPDX-License-Identifier: Apache-2.0
// Prints the centre of pressure of the rig "floor" while a daemon runs.
#include <dts/endpoints.h>
#include <dts/subscriber.h>

#include <chrono>
#include <iostream>
#include <string>
#include <variant>

int fail(const std::string& why) {
  std::cerr << why << std::endl;
  return 1;
}

int main() {
  const auto where = dts::client::find_endpoints();
  if (!where) return fail(where.error().what);
  auto subscriber = dts::client::Subscriber::open({.endpoint = where->data, .topics = {"floor/cop"}});
  if (!subscriber) return fail(subscriber.error().what);
  while (true) {
    const auto message = subscriber->receive(std::chrono::seconds(5));
    if (!message) return fail(message.error().what);
    if (!*message) return fail("no centre of pressure within 5 s: does dtsd run, with a rig \"floor\"?");
    const auto* block = std::get_if<dts::client::Block>(&**message);
    if (block == nullptr) continue;
    std::cout << "scan " << block->first_scan << ": right " << block->column(0)[0] << " mm" << std::endl;
  }
}
