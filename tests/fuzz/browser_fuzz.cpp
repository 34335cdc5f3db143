// SPDX-License-Identifier: Apache-2.0
// What a browser sends once it is let in: messages to a tab, between those of the bus. A tab does what its role may, tells nothing that
// cannot be read, and keeps within its bounds.
//
// Input: [role][0: the bus says something, 1: frames leave, else: a message of the browser][length, 2 bytes][FromBrowser] ..., see Pieces.
#include <google/protobuf/stubs/logging.h>

#include <array>
#include <memory>
#include <optional>

#include "dts/v1/gateway.pb.h"
#include "dts/wire/options.h"
#include "fuzz/fuzz_support.h"
#include "gateway/bus/hub.h"
#include "gateway/bus/tab_queue.h"

namespace dts::fuzz::browser {
namespace {

constexpr std::size_t kLongestReason = 120;  // of a close frame, see TabConnection
constexpr std::size_t kLongestRequestId = 64;
constexpr std::size_t kMostFrameBytes = gateway::TabQueue::kMostBytes + (256U << 10U);
constexpr std::array<const char*, 4> kTopics{"floor/cop", "floor/session", "floor/marker", "dtsd/status"};
constexpr std::array<gateway::Carried::Kind, 4> kKinds{gateway::Carried::Kind::Block, gateway::Carried::Kind::Event,
                                                       gateway::Carried::Kind::Event, gateway::Carried::Kind::Status};

/// Looks at all that a tab says.
class Listener final : public gateway::TabConnection {
 public:
  void send(std::string message) override {
    v1::FromGateway said;
    promise(message.size() <= kMostFrameBytes, "a message is bounded");
    promise(said.ParseFromString(message) && said.body_case() != v1::FromGateway::BODY_NOT_SET, "a message can be read");
    promise(said.response().request_id().size() <= kLongestRequestId, "an answer's id is short");
    if (said.has_response() && said.response().error().code() == v1::ERROR_CODE_NOT_ALLOWED) ++refused;
    ++answers;
  }
  [[nodiscard]] std::size_t unsent_bytes() const noexcept override { return 0; }
  void close(unsigned code, std::string reason) override {
    promise((code == 1008 || code == 4401) && !reason.empty() && reason.size() <= kLongestReason, "a close has a code and a reason");
    is_closed = true;
  }

  std::size_t answers = 0;
  std::size_t refused = 0;
  bool is_closed = false;
};

class Gateway {
 public:
  void let_pass() {
    io_.restart();
    io_.poll();
  }
  void publish(std::size_t which, std::string_view bytes) {
    hub_.handle(std::make_shared<gateway::Carried>(gateway::Carried{.topic = kTopics[which % kTopics.size()],
                                                                    .kind = kKinds[which % kKinds.size()],
                                                                    .bytes = std::string(bytes),
                                                                    .scans = 1,
                                                                    .is_retained = which % 2 != 0,
                                                                    .instance_id = 7}));
  }
  std::unique_ptr<gateway::Tab> open(v1::Role role, Listener& listener) { return hub_.open_tab({.user = "anna", .role = role}, listener); }
  [[nodiscard]] std::size_t wishes() const noexcept { return wishes_; }

 private:
  boost::asio::io_context io_;
  gateway::CommandPool commands_{io_, "ipc:///nonexistent/control.sock"};
  std::size_t wishes_ = 0;
  gateway::Hub hub_{io_, &commands_, [this](const std::vector<std::string>& wanted) { wishes_ = wanted.size(); }, "1.2.3"};
};

/// What a tab says to one message, before any daemon could have answered.
void hear(gateway::Tab& tab, v1::Role role, std::string_view bytes, Listener& listener) {
  const std::size_t answers = listener.answers;
  const std::size_t refused = listener.refused;
  tab.on_message(bytes);
  v1::FromBrowser message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) || message.body_case() == v1::FromBrowser::BODY_NOT_SET) {
    promise(listener.is_closed, "who speaks another language is left");
    return;
  }
  promise(listener.answers <= answers + 1, "at most one answer at once");
  const v1::Role needed = wire::rules_of(message.request()).role();
  const bool has_id = !message.request().request_id().empty() && message.request().request_id().size() <= kLongestRequestId;
  if (message.has_request() && has_id && needed > role) promise(listener.refused == refused + 1, "a command is for those who may");
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array kRoles{v1::ROLE_UNSPECIFIED, v1::ROLE_VIEWER, v1::ROLE_OPERATOR, v1::ROLE_ENGINEER};
  static const auto gateway = std::make_unique<Gateway>();
  google::protobuf::SetLogHandler(nullptr);  // what is no UTF-8 is no news here
  const std::string input = fuzz::text_of(bytes, size);
  fuzz::Pieces pieces(input);
  const v1::Role role = kRoles[pieces.byte() % kRoles.size()];
  Listener listener;
  auto tab = gateway->open(role, listener);
  for (std::size_t number = 0; !pieces.is_over() && !listener.is_closed; ++number) {
    const std::uint8_t what = pieces.byte();
    if (what == 1) {
      gateway->let_pass();
    } else if (const std::string_view piece = pieces.piece(); what == 0) {
      gateway->publish(number, piece);
    } else {
      hear(*tab, role, piece, listener);
    }
  }
  tab.reset();
  gateway->let_pass();
  promise(gateway->wishes() <= gateway::TabQueue::kMostPrefixes, "wishes are bounded, and end with their tab");
}

}  // namespace dts::fuzz::browser

DTS_FUZZ_TARGET(browser)
