// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/live.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <charconv>
#include <chrono>
#include <set>
#include <utility>

#include "fleet/desk/least_lead.h"
#include "fleet/desk/under_way.h"
#include "fleet/desk/watch.h"
#include "fleet/wire/subjects.h"
#include "gateway/bus/hub.h"

namespace dts::fleet::desk {
namespace {

constexpr unsigned kPolicyViolation = 1008;       // RFC 6455, 7.4.1
constexpr std::chrono::seconds kOffsetPause{10};  // as often as heartbeats

std::int64_t utc_now_ns() { return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count(); }

/// Reads how far the clinic's clock is ahead of the centre's.
core::Result<std::string> clock_offset(database::Database& database, const std::string& clinic) {
  DTS_TRY_ASSIGN(const database::Rows rows, database.run("SELECT clock_offset_s FROM beat WHERE clinic = $1", {clinic}));
  return rows.empty() ? std::string() : rows.text(0, 0);
}

}  // namespace

/// One clinic: its watch, and the hub of its tabs. Thread: io, but for the watch.
class ClinicView : public std::enable_shared_from_this<ClinicView> {
 public:
  ClinicView(boost::asio::io_context& io, QueryPool& queries, std::string clinic, const std::string& version)
      : io_(io),
        queries_(queries),
        clinic_(std::move(clinic)),
        timer_(io),
        hub_(
            io, nullptr, [this](std::vector<std::string> prefixes) { watch_->want(std::move(prefixes)); }, version,
            [this] { return host_time(); }) {}

  /// Starts the watch and reads the clock's offset. Call it once, before a tab is opened.
  void start(link::Link& link) {
    watch_ = std::make_unique<Watch>(link, clinic_, [this](gateway::BusItem item) { pass(std::move(item)); });
    ask_offset();
  }
  [[nodiscard]] std::unique_ptr<gateway::Tab> open_tab(const gateway::Identity& identity, gateway::TabConnection& connection) {
    return hub_.open_tab(identity, connection);
  }
  void add_viewer(const std::string& user) {
    viewers_.insert(user);
    pass_viewers();
  }
  void remove_viewer(const std::string& user) {
    viewers_.erase(viewers_.find(user));
    pass_viewers();
  }

 private:
  void pass(gateway::BusItem item);
  void handle(const gateway::BusItem& item);
  void pass_viewers() { watch_->set_viewers({viewers_.begin(), viewers_.end()}); }
  void ask_offset();
  [[nodiscard]] std::int64_t host_time() const;

  boost::asio::io_context& io_;
  QueryPool& queries_;
  std::string clinic_;
  boost::asio::steady_timer timer_;
  std::multiset<std::string> viewers_;
  double clock_offset_s_ = 0.0;                      ///< Until it is known: none.
  std::optional<std::int64_t> utc_minus_monotonic_;  ///< Of the clinic, ns.
  LeastLead lead_;
  UnderWay under_way_;
  gateway::Hub hub_;
  std::unique_ptr<Watch> watch_;  ///< Last: its thread ends first.
};

/// Thread: watch. What exceeds the limit is dropped; the page shows the missing scans.
void ClinicView::pass(gateway::BusItem item) {
  const auto* message = std::get_if<gateway::CarriedPointer>(&item);
  if (message != nullptr && !under_way_.add((*message)->bytes.size())) return;
  boost::asio::post(io_, [weak = weak_from_this(), item = std::move(item)] {
    if (const auto view = weak.lock()) view->handle(item);
  });
}

void ClinicView::handle(const gateway::BusItem& item) {
  const auto* message = std::get_if<gateway::CarriedPointer>(&item);
  if (message != nullptr) under_way_.remove((*message)->bytes.size());
  if (message != nullptr && (*message)->kind == gateway::Carried::Kind::Status) {
    v1::StatusSnapshot status;
    if (status.ParseFromString((*message)->bytes)) {
      utc_minus_monotonic_ = status.utc_minus_monotonic_ns();
      lead_.add(status.host_time_ns(), gateway::own_host_time());
    }
  }
  if (const auto* link = std::get_if<v1::Link>(&item); link != nullptr && !link->is_up()) {
    lead_ = {};  // the clinic's computer may start again
    utc_minus_monotonic_.reset();
  }
  hub_.handle(item);
}

void ClinicView::ask_offset() {
  queries_.submit([clinic = clinic_](database::Database& database) { return clock_offset(database, clinic); },
                  [weak = weak_from_this()](const core::Result<std::string>& text) {
                    const auto view = weak.lock();
                    if (!view) return;
                    if (text) (void)std::from_chars(text->data(), text->data() + text->size(), view->clock_offset_s_);
                    view->timer_.expires_after(kOffsetPause);
                    view->timer_.async_wait([weak](const boost::system::error_code& error) {
                      if (const auto still = weak.lock(); still && !error) still->ask_offset();
                    });
                  });
}

/// The clinic's CLOCK_MONOTONIC. The offset in the heartbeat is too small by the time that the heartbeat was under way.
std::int64_t ClinicView::host_time() const {
  if (!utc_minus_monotonic_) return 0;
  const std::int64_t delay_ns = watch_->delay().value_or(std::chrono::nanoseconds(0)).count();
  const std::int64_t by_clocks = utc_now_ns() + static_cast<std::int64_t>(clock_offset_s_ * 1e9) + delay_ns - *utc_minus_monotonic_;
  return std::max(by_clocks, gateway::own_host_time() + *lead_.ns());
}

namespace {

/// A tab that keeps its view.
class ViewTab final : public gateway::Tab {
 public:
  ViewTab(std::shared_ptr<ClinicView> view, const gateway::Identity& identity, gateway::TabConnection& connection)
      : view_(std::move(view)), user_(identity.user), tab_(view_->open_tab(identity, connection)) {
    view_->add_viewer(user_);
  }
  ~ViewTab() override { view_->remove_viewer(user_); }
  ViewTab(const ViewTab&) = delete;
  ViewTab& operator=(const ViewTab&) = delete;
  ViewTab(ViewTab&&) = delete;
  ViewTab& operator=(ViewTab&&) = delete;

  void on_message(std::string_view message) override { tab_->on_message(message); }

 private:
  std::shared_ptr<ClinicView> view_;
  std::string user_;
  std::unique_ptr<gateway::Tab> tab_;  ///< Last: it leaves the view's hub first.
};

class ClosedTab final : public gateway::Tab {
 public:
  void on_message(std::string_view /*message*/) override {}
};

}  // namespace

Live::Live(boost::asio::io_context& io, link::Link& link, QueryPool& queries, std::string version)
    : io_(io), link_(link), queries_(queries), version_(std::move(version)) {}
Live::~Live() = default;

std::unique_ptr<gateway::Tab> Live::open_tab(const gateway::Identity& identity, const std::string& clinic,
                                             gateway::TabConnection& connection) {
  if (!wire::is_clinic_name(clinic)) {
    connection.close(kPolicyViolation, "the address names no clinic");
    return std::make_unique<ClosedTab>();
  }
  std::erase_if(views_, [](const auto& entry) { return entry.second.expired(); });
  auto view = views_[clinic].lock();
  if (!view) {
    view = std::make_shared<ClinicView>(io_, queries_, clinic, version_);
    views_[clinic] = view;
    view->start(link_);
  }
  return std::make_unique<ViewTab>(std::move(view), identity, connection);
}

}  // namespace dts::fleet::desk
