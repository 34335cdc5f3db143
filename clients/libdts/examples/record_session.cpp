// SPDX-License-Identifier: Apache-2.0
// Records a session of some seconds and prints the recorded files: record_session RIG SECONDS
#include <dts/control_client.h>
#include <dts/endpoints.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>

namespace client = dts::client;

namespace {

int report(const client::Error& error) {
  std::cerr << error.what << '\n' << error.hint << '\n';
  return 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::cerr << "usage: record_session RIG SECONDS\n";
    return 2;
  }
  const auto where = client::find_endpoints();
  if (!where) return report(where.error());
  auto daemon = client::ControlClient::open({.endpoint = where->control});
  if (!daemon) return report(daemon.error());

  dts::v1::StartSessionRequest request;
  request.set_rig(arguments[1]);
  request.set_protocol("free");
  request.set_subject("P017");
  const auto started = daemon->start_session(request);
  if (!started) return report(started.error());
  std::this_thread::sleep_for(std::chrono::duration<double>(std::atof(arguments[2])));
  const auto stopped = daemon->stop_session(arguments[1]);
  if (!stopped) return report(stopped.error());

  const auto session = daemon->show_session(stopped->session_id());
  if (!session) return report(session.error());
  for (const auto& part : session->parts()) std::cout << part.file() << '\n';
}
