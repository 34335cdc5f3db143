// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/watch.h"

#include <pthread.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <utility>

#include "dts/wire/options.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::desk {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kRenewal{4000};      // the lease is 10 s
constexpr milliseconds kShortestPause{50};  // between two requests, if a clinic rejects them again and again
constexpr milliseconds kTurn{20};
constexpr milliseconds kPause{100};
constexpr milliseconds kPatience{2000};  // for the first answer of a clinic
constexpr milliseconds kSilence{3000};   // the clinic publishes dtsd's status every second
constexpr int kMostLettersInATurn = 256;

template <class Message>
std::shared_ptr<const gateway::Carried> carried(const std::string& topic, std::string&& bytes, gateway::Carried::Kind kind) {
  Message message;
  if (!message.ParseFromString(bytes)) return nullptr;
  gateway::Carried made{.topic = topic, .kind = kind, .bytes = std::move(bytes), .instance_id = message.instance_id()};
  if constexpr (std::is_same_v<Message, v1::StreamBlock>) made.scans = message.scan_count();
  if constexpr (std::is_same_v<Message, v1::Event>) made.is_retained = dts::wire::topic_of(message).is_retained();
  if constexpr (std::is_same_v<Message, v1::StatusSnapshot>) made.is_retained = true;
  return std::make_shared<const gateway::Carried>(std::move(made));
}

}  // namespace

gateway::CarriedPointer carried_of(const std::string& topic, std::string bytes) {
  if (bytes.size() > wire::kLargestMessage) return nullptr;
  if (topic == gateway::kStatusTopic) return carried<v1::StatusSnapshot>(topic, std::move(bytes), gateway::Carried::Kind::Status);
  const bool is_event = dts::wire::is_event_topic(std::string_view(topic).substr(topic.find('/') + 1));
  if (is_event) return carried<v1::Event>(topic, std::move(bytes), gateway::Carried::Kind::Event);
  return carried<v1::StreamBlock>(topic, std::move(bytes), gateway::Carried::Kind::Block);
}

std::vector<std::string> topics_of(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes) {
  std::vector<std::string> topics{std::string(gateway::kStatusTopic)};
  if (status == nullptr) return topics;
  std::vector<std::string> wanted;
  const auto offer = [&](std::string topic) {
    if (std::ranges::any_of(prefixes, [&](const std::string& prefix) { return topic.starts_with(prefix); }))
      wanted.push_back(std::move(topic));
  };
  for (const v1::RigStatus& rig : status->rigs()) {
    for (const v1::Topic& event : dts::wire::event_topics()) {
      const std::string topic = rig.rig().name() + "/" + event.name();
      if (event.is_retained())
        topics.push_back(topic);
      else
        offer(topic);
    }
    for (const std::string& stream : rig.rig().published()) offer(rig.rig().name() + "/" + stream);
  }
  topics.insert(topics.end(), wanted.begin(), wanted.end());
  std::ranges::sort(topics.begin() + 1, topics.end());
  topics.erase(std::unique(topics.begin(), topics.end()), topics.end());
  if (topics.size() > kMostTopics) topics.resize(kMostTopics);
  return topics;
}

std::string problem_of_status(const v1::StatusSnapshot& status) {
  if (status.rigs_size() > kMostRigs) return "the clinic reports more than " + std::to_string(kMostRigs) + " rigs";
  const bool is_sound =
      std::ranges::all_of(status.rigs(), [](const v1::RigStatus& rig) { return rig.rig().published_size() <= kMostStreams; });
  return is_sound ? "" : "the clinic reports more than " + std::to_string(kMostStreams) + " streams of a rig";
}

class Watch::Loop {
 public:
  Loop(link::Link& link, std::string clinic, std::function<void(gateway::BusItem)> on_item)
      : link_(link), clinic_(std::move(clinic)), on_item_(std::move(on_item)) {}

  void run(const std::stop_token& stop) noexcept;
  void want(std::vector<std::string> prefixes) {
    const std::lock_guard lock(mutex_);
    prefixes_ = std::move(prefixes);
    has_new_wish_ = true;
  }
  void set_viewers(std::set<std::string> names) {
    const std::lock_guard lock(mutex_);
    viewers_ = std::move(names);
    has_new_wish_ = true;
  }
  [[nodiscard]] std::int64_t delay_ns() const noexcept { return delay_ns_.load(std::memory_order_relaxed); }

 private:
  /// What is asked of the clinic.
  struct Wish {
    std::vector<std::string> topics;
    std::set<std::string> viewers;
    friend bool operator==(const Wish&, const Wish&) = default;
  };
  void turn(const std::stop_token& stop);
  [[nodiscard]] bool connect();
  void renew_wish();
  void ask_if_due();
  void read_answers();
  void read_letters();
  [[nodiscard]] bool pass_on(link::Letter&& letter);
  [[nodiscard]] bool take_status(const std::string& bytes);
  void judge();
  void report(bool is_up, const std::string& problem);

  link::Link& link_;
  const std::string clinic_;
  const std::function<void(gateway::BusItem)> on_item_;
  std::unique_ptr<link::Subscription> live_;
  std::unique_ptr<link::Subscription> answers_;
  std::string inbox_;
  std::uint64_t connections_ = 0;
  std::optional<v1::StatusSnapshot> status_;
  std::string status_problem_;  ///< Of the newest status.
  bool has_new_status_ = false;
  Wish wish_;
  Wish asked_;
  Clock::time_point asked_at_{};
  Clock::time_point first_asked_at_{};
  std::uint64_t round_ = 0;
  bool is_answered_ = false;
  std::string refusal_;
  Clock::time_point received_at_{};
  bool is_up_ = false;
  std::optional<std::string> reported_;
  std::atomic<std::int64_t> delay_ns_ = -1;
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::vector<std::string> prefixes_;  ///< Guarded by `mutex_`, as the next two.
  std::set<std::string> viewers_;
  bool has_new_wish_ = true;
};

/// Catches what libraries throw, for example if memory runs out.
void Watch::Loop::run(const std::stop_token& stop) noexcept {
  ::pthread_setname_np(::pthread_self(), "watch");
  while (!stop.stop_requested()) {
    try {
      turn(stop);
    } catch (const std::exception&) {
      live_.reset();  // the next turn subscribes again
    }
  }
  answers_.reset();
  live_.reset();
}

void Watch::Loop::turn(const std::stop_token& stop) {
  if (!connect()) {
    judge();
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, stop, kPause, [] { return false; });
    return;
  }
  ask_if_due();
  read_answers();
  read_letters();
  judge();
}

/// Subscribes once: the link subscribes again by itself after an interruption. Returns false without a connection.
bool Watch::Loop::connect() {
  if (!live_ || !answers_) {
    answers_.reset();
    live_.reset();
    inbox_ = link_.new_inbox();
    auto live = link_.subscribe(wire::to_text({.clinic = clinic_, .matter = wire::Matter::Live, .topic = ">"}));
    auto answers = link_.subscribe(inbox_ + ".*");
    if (!live || !answers) return false;
    live_ = std::move(*live);
    answers_ = std::move(*answers);
  }
  return link_.is_connected();
}

void Watch::Loop::renew_wish() {
  const std::lock_guard lock(mutex_);
  if (!has_new_status_ && !has_new_wish_) return;
  has_new_status_ = false;
  has_new_wish_ = false;
  wish_ = {.topics = topics_of(status_ ? &*status_ : nullptr, prefixes_), .viewers = viewers_};
}

void Watch::Loop::ask_if_due() {
  renew_wish();
  const auto now = Clock::now();
  const auto pause = now - asked_at_;
  const bool is_due = wish_ != asked_ || link_.connections() != connections_ || pause >= (is_answered_ ? kRenewal : kPatience / 2);
  if (!is_due || pause < kShortestPause) return;
  connections_ = link_.connections();
  asked_ = wish_;
  asked_at_ = now;
  if (first_asked_at_ == Clock::time_point()) first_asked_at_ = now;
  is_answered_ = false;
  ++round_;
  for (const std::string& viewer : asked_.viewers) {
    v1::LiveRequest request;
    *request.mutable_topics() = {asked_.topics.begin(), asked_.topics.end()};
    request.set_who(viewer);
    (void)link_.publish({.subject = wire::to_text({.clinic = clinic_, .matter = wire::Matter::DownLive}),
                         .reply = inbox_ + "." + std::to_string(round_),
                         .data = request.SerializeAsString()});
  }
}

void Watch::Loop::read_answers() {
  while (const auto letter = answers_->next(milliseconds(0))) {
    if (letter->has_no_listener) continue;
    const auto answer = wire::decode_live_answer(letter->data);
    if (!answer || letter->subject != inbox_ + "." + std::to_string(round_)) continue;
    const std::int64_t half_ns = std::chrono::nanoseconds(Clock::now() - asked_at_).count() / 2;
    const std::int64_t known_ns = delay_ns_.load(std::memory_order_relaxed);
    if (!is_answered_ && (known_ns < 0 || half_ns < known_ns)) delay_ns_.store(half_ns, std::memory_order_relaxed);
    is_answered_ = true;
    refusal_ = answer->has_refusal() ? "the clinic answers: " + answer->refusal().reason() : "";
    if (!answer->has_refusal()) continue;
    status_.reset();  // its rigs may be others now
    has_new_status_ = true;
  }
}

void Watch::Loop::read_letters() {
  auto letter = live_->next(kTurn);
  for (int count = 0; letter && count < kMostLettersInATurn; ++count) {
    if (!pass_on(std::move(*letter))) return;  // a sound status behind it must not hide its problem from `judge`
    letter = live_->next(milliseconds(0));
  }
  if (letter) (void)pass_on(std::move(*letter));
}

/// Returns false for a status that must not be passed on. Other letters that are not for anybody are dropped.
bool Watch::Loop::pass_on(link::Letter&& letter) {
  const auto subject = wire::parse_subject(letter.subject);
  if (!subject || subject->matter != wire::Matter::Live || subject->clinic != clinic_) return true;
  if (std::ranges::find(asked_.topics, subject->topic) == asked_.topics.end()) return true;  // nobody asked for it
  auto message = carried_of(subject->topic, std::move(letter.data));
  if (!message) return true;
  if (message->kind == gateway::Carried::Kind::Status && !take_status(message->bytes)) return false;
  received_at_ = Clock::now();
  if (is_up_) on_item_(std::move(message));
  return true;
}

/// Returns false for a status that must not be passed on.
bool Watch::Loop::take_status(const std::string& bytes) {
  v1::StatusSnapshot status;
  (void)status.ParseFromString(bytes);
  status_problem_ = problem_of_status(status);
  if (!status_problem_.empty()) return false;
  status_ = std::move(status);
  has_new_status_ = true;
  report(true, {});
  return true;
}

void Watch::Loop::judge() {
  if (!link_.is_connected()) return report(false, "the centre has no connection to nats-server");
  if (!refusal_.empty()) return report(false, refusal_);
  if (!status_problem_.empty()) return report(false, status_problem_);
  const auto now = Clock::now();
  const bool is_silent = now - std::max(received_at_, first_asked_at_) > (received_at_ == Clock::time_point() ? kPatience : kSilence);
  if (is_silent) report(false, is_answered_ ? "the clinic sends no data" : "the clinic is not connected to the centre");
}

void Watch::Loop::report(bool is_up, const std::string& problem) {
  if (reported_ == problem) return;
  reported_ = problem;
  is_up_ = is_up;
  v1::Link link;
  link.set_is_up(is_up);
  link.set_problem(problem);
  on_item_(std::move(link));
}

Watch::Watch(link::Link& link, std::string clinic, std::function<void(gateway::BusItem)> on_item)
    : loop_(std::make_unique<Loop>(link, std::move(clinic), std::move(on_item))),
      thread_([loop = loop_.get()](const std::stop_token& stop) { loop->run(stop); }) {}

Watch::~Watch() = default;

void Watch::want(std::vector<std::string> prefixes) { loop_->want(std::move(prefixes)); }
void Watch::set_viewers(std::set<std::string> names) { loop_->set_viewers(std::move(names)); }

std::optional<std::chrono::nanoseconds> Watch::delay() const noexcept {
  const std::int64_t delay_ns = loop_->delay_ns();
  return delay_ns < 0 ? std::nullopt : std::optional(std::chrono::nanoseconds(delay_ns));
}

}  // namespace dts::fleet::desk
