// SPDX-License-Identifier: Apache-2.0
// Commands from a stranger, from the bytes of a message to the bytes of its answer: parser, gate, handler. Two daemons without sockets hear
// each: one with a rig and protocols on a disk that is too full for a session, one with a catalogue and no rig. What they know grows during
// a run, so that a find may need the inputs before it; sessions and keys are undone after each.
//
// Input: [peer][length, 2 bytes][Request] ... , see Pieces.
#include <google/protobuf/stubs/logging.h>

#include <array>
#include <memory>
#include <utility>

#include "../clients/libdts/wire_check.h"
#include "access/gate.h"
#include "core/worker.h"
#include "dts/wire/options.h"
#include "fuzz/fuzz_support.h"
#include "ipc/audit_trail.h"
#include "ipc/command_handler.h"
#include "session/recordings.h"

namespace dts::fuzz::control {
namespace {

constexpr std::size_t kMostRequests = 8;
constexpr std::size_t kLongestRequestId = 64;
constexpr std::array<std::pair<const char*, v1::Role>, 5> kPeers{{{"", v1::ROLE_ENGINEER},
                                                                  {"vera", v1::ROLE_VIEWER},
                                                                  {"otto", v1::ROLE_OPERATOR},
                                                                  {"ina", v1::ROLE_ENGINEER},
                                                                  {"gone", v1::ROLE_UNSPECIFIED}}};

pipeline::RigConfig floor_rig() {
  pipeline::RigConfig config{.name = "floor", .kind = "floor", .device_uri = "sim:floor"};
  config.sensor_channels = {0};
  config.model.sensors.push_back({.label = "w1", .position = {.x = {86.0}, .y = {86.0}}, .curve = physics::SensorCurve::hoa1405_assumed()});
  config.rate = core::Rate::create(100, 1).value();
  config.stages.push_back({.id = "guard", .options = {}});
  config.published = {"raw"};
  return config;
}

std::vector<session::Protocol> protocols() {
  session::Protocol reach{
      .name = "reach",
      .sentence = "One trial.",
      .fields = {{.name = "arm_length_cm", .label = "Arm length", .is_required = true, .minimum = 40.0, .maximum = 100.0}}};
  reach.trials = session::TrialPlan{.conditions = {{.name = "120", .target_percent = 120.0}}, .trials_per_block = 1};
  return {session::free_protocol(), std::move(reach)};
}

class Daemons {
 public:
  Daemons()
      : keys_(access::KeyStore::open(folder_.file("keys")).value()),
        gate_(keys_.get()),
        recordings_(session::Recordings::open({.directory = folder_.file("state")}, clock_, {}).value()),
        full_disk_(session::Recordings::open({.directory = folder_.file("full"), .refuse_below_min = 1e15}, clock_, {}).value()),
        with_rig_(clock_, {}, nullptr, {.recordings = *full_disk_, .worker = worker_, .protocols = protocols()}),
        with_catalogue_(clock_, {}, nullptr, {.recordings = *recordings_, .worker = worker_}),
        rig_handler_(with_rig_, clock_, kIdentity, {"a notice"}, {keys_.get(), clock_, {}}),
        catalogue_handler_(with_catalogue_, clock_, kIdentity, {},
                           {keys_.get(), clock_, settings::RemoteEndpoints{.control = "tcp://*:5555", .data = "tcp://*:5556"}}) {
    promise(with_rig_.add(session::Rig::create(floor_rig(), clock_, bell_).value()).has_value(), "a rig");
    for (const auto& [name, role] : kPeers) {
      if (*name == '\0' || role == v1::ROLE_UNSPECIFIED) continue;
      promise(keys_->add({.name = name, .role = role, .public_key = key_of(name[0]), .created_utc = ""}).has_value(), "a key");
    }
  }

  void hear(std::size_t peer, std::string_view bytes) {
    const char* const name = kPeers[peer].first;
    const access::Peer sender = *name == '\0' ? access::Gate::local() : gate_.remote(key_of(name[0]));
    clock_.advance_ns(core::kNanosecondsPerSecond);
    v1::Request request;
    if (!request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return;
    if (request.request_id().empty() || request.request_id().size() > kLongestRequestId) return;
    if (!is_allowed(sender, request)) return;
    answer(with_rig_, rig_handler_, sender, request);
    answer(with_catalogue_, catalogue_handler_, sender, request);
    with_rig_.tick();
    (void)with_rig_.take_notices();
  }

  /// Everything as it was, but for the audit trail.
  void undo() {
    (void)with_rig_.stop_session("floor");
    for (int turn = 0; turn < 3; ++turn) with_rig_.tick();
    (void)with_rig_.take_notices();
    for (const access::ClientKey& key : keys_->keys()) {
      if (std::ranges::none_of(kPeers, [&](const auto& known) { return key.name == known.first; })) (void)keys_->revoke(key.name);
    }
    for (const auto& [name, role] : kPeers) {
      if (*name != '\0' && role != v1::ROLE_UNSPECIFIED && !keys_->find_by_public_key(key_of(name[0]))) {
        (void)keys_->add({.name = name, .role = role, .public_key = key_of(name[0]), .created_utc = ""});
      }
    }
    if (keys_->find_by_public_key(key_of('g'))) (void)keys_->revoke("gone");
  }

 private:
  static const ipc::Identity kIdentity;

  static std::string key_of(char letter) { return std::string(39, '0') + letter; }

  static bool is_allowed(const access::Peer& sender, const v1::Request& request) {
    const bool is_allowed = access::Gate::check(sender, request).has_value();
    const bool has_command = request.command_case() != v1::Request::COMMAND_NOT_SET;
    const bool is_of_a_gateway = request.has_note_login() && sender.is_remote;  // only those on the daemon's machine enter logins
    const bool may = !has_command || (sender.role >= wire::rules_of(request).role() && !is_of_a_gateway);
    promise(is_allowed == may, "a command runs for those who may");
    return is_allowed;
  }

  void answer(session::Supervisor& supervisor, ipc::CommandHandler& handler, const access::Peer& sender, const v1::Request& request) {
    ipc::CommandHandler::Answer answer = handler.execute(request);
    if (answer.pending) {
      auto finished = handler.finish(*answer.pending);
      answer.response = finished ? std::move(*finished) : handler.give_up(*answer.pending);
      answer.response.set_request_id(request.request_id());
    }
    ipc::enter_audit(supervisor, clock_, sender.who, request, answer.response);
    promise(answer.response.result_case() != v1::Response::RESULT_NOT_SET, "every request gets an answer");
    promise(answer.response.request_id() == request.request_id(), "an answer names its request");
    const std::string bytes = answer.response.SerializeAsString();
    promise(bytes.size() <= client::kMaxAnswerBytes, "an answer is one that clients take");
    v1::Response read;
    promise(read.ParseFromString(bytes), "an answer can be read");
    promise(client::check(read).has_value(), "an answer makes sense to clients");
  }

  fuzz::Folder folder_;
  core::VirtualClock clock_{core::kNanosecondsPerSecond};
  core::Doorbell bell_;
  std::unique_ptr<access::KeyStore> keys_;
  access::Gate gate_;
  core::Worker worker_{"analyse"};
  std::unique_ptr<session::Recordings> recordings_;
  std::unique_ptr<session::Recordings> full_disk_;
  session::Supervisor with_rig_;
  session::Supervisor with_catalogue_;
  ipc::CommandHandler rig_handler_;
  ipc::CommandHandler catalogue_handler_;
};

const ipc::Identity Daemons::kIdentity{.instance_id = 1, .version = "1.2.3", .boot_id = "boot", .started_ns = 0};

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  constexpr int kRunsOfOneFolder = 2000;  // the audit trail only grows
  static std::unique_ptr<Daemons> daemons;
  static int runs = 0;
  if (runs++ % kRunsOfOneFolder == 0) daemons.reset();
  if (!daemons) daemons = std::make_unique<Daemons>();
  google::protobuf::SetLogHandler(nullptr);  // what is no UTF-8 is no news here
  const std::string input = fuzz::text_of(bytes, size);
  fuzz::Pieces pieces(input);
  const std::size_t peer = pieces.byte() % kPeers.size();
  for (std::size_t number = 0; number < kMostRequests && !pieces.is_over(); ++number) daemons->hear(peer, pieces.piece());
  daemons->undo();
}

}  // namespace dts::fuzz::control

DTS_FUZZ_TARGET(control)
