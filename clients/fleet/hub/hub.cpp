// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/hub.h"

#include <signal.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "core/token_bucket.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/cleaner.h"
#include "fleet/hub/desk.h"
#include "fleet/hub/erasures.h"
#include "fleet/hub/ingest.h"
#include "fleet/hub/keeper.h"
#include "fleet/hub/metrics.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/nkey.h"

namespace dts::fleet::hub {
namespace {

using database::Database;

constexpr int kServeMs = 100;  // how long a turn waits for a signal
constexpr auto kLongestEnd = std::chrono::milliseconds(1500);
constexpr std::uint32_t kLaterS = 5;
constexpr int kFactsDesks = 4;
constexpr const char* kCatalogueAway = "the catalogue of the centre does not answer";

/// Returns true if SIGTERM or SIGINT has arrived, after at most `kServeMs`.
bool is_end_requested() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT}) sigaddset(&wanted, signal);
  const timespec wait{.tv_sec = 0, .tv_nsec = kServeMs * 1'000'000L};
  return sigtimedwait(&wanted, nullptr, &wait) > 0;
}

/// A connection to PostgreSQL of one desk.
struct Seat {
  Seat(const Settings& settings, const std::string& name, bool is_durable)
      : database({.connection = settings.connection, .name = "dts-hub " + name, .is_durable = is_durable}),
        catalogue(database, settings.quota) {}
  Database database;
  Catalogue catalogue;
};

template <class Answer>
Answer refused(const std::string& reason) {
  Answer answer;
  answer.mutable_refusal()->set_reason(reason);
  return answer;
}

template <class Answer>
Answer not_now() {
  Answer answer;
  answer.mutable_later()->set_reason(kCatalogueAway);
  answer.mutable_later()->set_wait_s(kLaterS);
  return answer;
}

/// All that the hub consists of.
class Hub {
 public:
  Hub(const Settings& settings, wire::NKey key, std::string ca_pem, core::Clock& clock, const core::Log& log)
      : settings_(settings), key_(std::move(key)), ca_pem_(std::move(ca_pem)), clock_(clock), log_(log) {}

  [[nodiscard]] core::Status start() {
    DTS_TRY_ASSIGN(store_, open_store(settings_));
    DTS_TRY(ErasureJournal(settings_.directory).create());
    DTS_TRY_ASSIGN(auto staging, Staging::open(settings_.directory + "/staging/" + settings_.name));
    DTS_TRY_ASSIGN(ingest_, Ingest::create({.hub = settings_.name,
                                            .full_at_percent = settings_.full_at_percent,
                                            .bytes_a_day = settings_.quota.bytes_a_day,
                                            .staged_bytes = settings_.quota.staged_bytes},
                                           std::move(staging), *store_, clock_, log_));
    if (!settings_.metrics_address.empty()) {
      auto seat = std::make_shared<Seat>(settings_, "metrics", true);
      DTS_TRY_ASSIGN(
          metrics_, MetricsListener::open(settings_.metrics_address, settings_.metrics_port, [this, seat] {
            return metrics_text({ingest_->counts(), counts_, quota_.slowed(), *store_, settings_.quota, is_connected_}, seat->database);
          }));
    }
    keeper_ = std::make_unique<Keeper>(settings_, key_.public_key, clinics_, log_);
    cleaner_ = std::make_unique<Cleaner>(settings_, *ingest_, *store_, clock_, log_);
    return open_desks();
  }

  /// Says once if nats-server rejects the key: it may not have read the users file yet. The link tries again.
  void serve() {
    is_connected_ = link_->is_connected();
    if (is_connected_) is_rejection_logged_ = false;
    if (link_->is_rejected() && !std::exchange(is_rejection_logged_, true)) {
      log_.error(
          "nats-server rejects the key of this hub: run dts-fleet users, and include the file that it writes in nats-server's "
          "configuration");
    }
  }

  void request_stop() {
    for (const auto& desk : desks_) desk->request_stop();
    keeper_->request_stop();
    cleaner_->request_stop();
  }

 private:
  [[nodiscard]] core::Status open_desks() {
    DTS_TRY_ASSIGN(link_, link::Link::open({.servers = settings_.servers,
                                            .ca_pem = ca_pem_,
                                            .name = settings_.name,
                                            .seed = key_.seed,
                                            .inbox_prefix = std::string(wire::kHubInboxPrefix)},
                                           log_));
    DTS_TRY(add_desk(wire::Matter::Open, "", "open", opens()));
    DTS_TRY(add_desk(wire::Matter::Chunk, settings_.name, "chunk", chunks()));
    DTS_TRY(add_desk(wire::Matter::Commit, settings_.name, "commit", commits()));
    // Several, so that their commits share the wait for the disk; revisions make the order irrelevant.
    for (int number = 1; number <= kFactsDesks; ++number)
      DTS_TRY(add_desk(wire::Matter::Facts, "", "facts-" + std::to_string(number), facts()));
    DTS_TRY(add_desk(wire::Matter::Erase, "", "erase", erasures()));
    return add_desk(wire::Matter::Beat, "", "beat", beats());
  }

  [[nodiscard]] core::Status add_desk(wire::Matter matter, const std::string& worker, const std::string& name, Desk::Handler handler) {
    DTS_TRY_ASSIGN(auto desk, Desk::open({*link_, clinics_, quota_, counts_, log_}, matter, worker, name, std::move(handler)));
    desks_.push_back(std::move(desk));
    return {};
  }

  [[nodiscard]] std::int64_t utc_ns() const { return clock_.now_ns() + clock_.utc_minus_monotonic_ns(); }

  /// Logs a failure of the catalogue, at most once a second of all desks.
  void log_failure(const core::Error& error) {
    const std::lock_guard lock(log_mutex_);
    if (failures_.take(std::chrono::steady_clock::now())) log_.warning(core::to_string(error));
  }

  Desk::Handler opens() {
    auto seat = std::make_shared<Seat>(settings_, "open", true);
    return [this, seat](const std::string& clinic, std::string_view data, const std::stop_token& /*stop*/) {
      const auto offer = wire::decode_offer(data);
      if (!offer) return refused<v1::UploadAnswer>(offer.error().what).SerializeAsString();
      return ingest_->open(clinic, *offer, seat->catalogue).SerializeAsString();
    };
  }

  Desk::Handler chunks() {
    return [this](const std::string& clinic, std::string_view data, const std::stop_token& /*stop*/) {
      const auto chunk = wire::decode_chunk(data);
      if (!chunk) return refused<v1::UploadAnswer>(chunk.error().what).SerializeAsString();
      return ingest_->take(clinic, *chunk).SerializeAsString();
    };
  }

  Desk::Handler commits() {
    auto seat = std::make_shared<Seat>(settings_, "commit", true);
    return [this, seat](const std::string& clinic, std::string_view data, const std::stop_token& stop) {
      const auto commit = wire::decode_commit(data);
      if (!commit) return refused<v1::UploadAnswer>(commit.error().what).SerializeAsString();
      return ingest_->commit(clinic, *commit, seat->catalogue, stop).SerializeAsString();
    };
  }

  Desk::Handler facts() {
    auto seat = std::make_shared<Seat>(settings_, "facts", true);
    return [this, seat](const std::string& clinic, std::string_view data, const std::stop_token& /*stop*/) {
      const auto session = wire::decode_session(data);
      if (!session) return refused<v1::FactsAnswer>(session.error().what).SerializeAsString();
      const auto revision = seat->catalogue.put_session(clinic, *session);
      v1::FactsAnswer answer;
      if (revision) {
        answer.set_revision(*revision);
        return answer.SerializeAsString();
      }
      if (revision.error().code == core::ErrorCode::NotFound || revision.error().code == core::ErrorCode::WrongState) {
        return refused<v1::FactsAnswer>(revision.error().what).SerializeAsString();
      }
      log_failure(revision.error());
      return not_now<v1::FactsAnswer>().SerializeAsString();
    };
  }

  Desk::Handler erasures() {
    auto seat = std::make_shared<Seat>(settings_, "erase", true);
    return [this, seat](const std::string& clinic, std::string_view data, const std::stop_token& /*stop*/) {
      const auto erase = wire::decode_erase(data);
      if (!erase) return refused<v1::EraseAnswer>(erase.error().what).SerializeAsString();
      const auto removed = erase_session({.clinic = clinic, .id = erase->session_id()}, seat->catalogue);
      v1::EraseAnswer answer;
      if (removed) {
        answer.set_files(*removed);
        return answer.SerializeAsString();
      }
      if (removed.error().code == core::ErrorCode::WrongState) return refused<v1::EraseAnswer>(removed.error().what).SerializeAsString();
      log_failure(removed.error());
      return not_now<v1::EraseAnswer>().SerializeAsString();
    };
  }

  [[nodiscard]] core::Result<std::uint32_t> erase_session(const SessionName& session, Catalogue& catalogue) {
    Erasures erasures(catalogue, *store_, ErasureJournal(settings_.directory));
    DTS_TRY_ASSIGN(const std::uint32_t files, erasures.erase(session, "clinic:" + session.clinic, utc_ns()));
    DTS_TRY(ingest_->drop_session(session, catalogue));
    return files;
  }

  Desk::Handler beats() {
    // Not durable: the newest beats are worthless after a power failure.
    auto seat = std::make_shared<Seat>(settings_, "beat", false);
    return [this, seat](const std::string& clinic, std::string_view data, const std::stop_token& /*stop*/) -> std::optional<std::string> {
      const auto beat = wire::decode_beat(data);
      const std::int64_t now = utc_ns();
      const auto head = beat ? seat->catalogue.put_beat(clinic, *beat, now) : core::Result<std::string>(tl::make_unexpected(beat.error()));
      if (!head) {
        log_failure(head.error());
        return std::nullopt;
      }
      v1::BeatAnswer answer;
      answer.set_utc_ns(now);
      answer.set_hub(settings_.name);
      answer.set_audit_head(*head);
      return answer.SerializeAsString();
    };
  }

  const Settings& settings_;
  wire::NKey key_;
  std::string ca_pem_;
  core::Clock& clock_;
  const core::Log& log_;
  ClinicList clinics_{};
  MessageQuota quota_{settings_.quota.messages_per_s};
  DeskCounts counts_{};
  std::mutex log_mutex_{};
  core::TokenBucket failures_{1.0};
  std::atomic<bool> is_connected_{false};
  bool is_rejection_logged_ = false;
  std::unique_ptr<Store> store_{};
  std::unique_ptr<Ingest> ingest_{};
  std::unique_ptr<MetricsListener> metrics_{};
  std::unique_ptr<Keeper> keeper_{};
  std::unique_ptr<Cleaner> cleaner_{};
  std::unique_ptr<link::Link> link_{};
  std::vector<std::unique_ptr<Desk>> desks_{};  ///< Must be the last member: they use the others.
};

}  // namespace

core::Status run_hub(const Settings& settings, core::Clock& clock, const core::Log& log) {
  DTS_TRY_ASSIGN(auto key, wire::read_or_create_nkey(settings.key_file));
  DTS_TRY_ASSIGN(auto ca_pem, read_ca(settings));
  Hub hub(settings, std::move(key), std::move(ca_pem), clock, log);
  DTS_TRY(hub.start());
  log.info("hub " + settings.name + " serves the clinics of " + settings.servers.front());
  sd_notifyf(0, "READY=1\nSTATUS=hub %s", settings.name.c_str());
  while (!is_end_requested()) hub.serve();
  sd_notify(0, "STOPPING=1");
  // A thread that waits for PostgreSQL or a disk must not delay the end. Nothing is lost: the hub may be killed at any time.
  std::thread([] {
    std::this_thread::sleep_for(kLongestEnd);
    ::_exit(0);
  }).detach();
  hub.request_stop();
  return {};
}

}  // namespace dts::fleet::hub
