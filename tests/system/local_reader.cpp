// SPDX-License-Identifier: Apache-2.0
// A subscriber in mode Latest: local_reader ENDPOINT PREFIX STREAM. Prints the last scan of each block of STREAM that it receives.
#include <cstdio>
#include <string>

#include "dts/subscriber.h"

int main(int count, char** arguments) {
  namespace client = dts::client;
  if (count != 4) return 2;
  // On a slow machine, catching up can take longer than the default of 100 ms: the daemon must get a core first.
  auto subscriber = client::Subscriber::open(
      {.endpoint = arguments[1], .topics = {arguments[2]}, .mode = client::Mode::Latest, .catch_up = std::chrono::seconds(5)});
  while (subscriber) {
    const auto message = subscriber->receive(std::chrono::seconds(1));
    if (!message) return 1;
    const auto* block = *message ? std::get_if<client::Block>(&**message) : nullptr;
    if (block == nullptr || block->topic != std::string_view(arguments[3])) continue;
    std::printf("%llu\n", static_cast<unsigned long long>(block->first_scan + block->scan_count - 1));
    if (std::fflush(stdout) != 0) return 0;
  }
  return 1;
}
