// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/metrics.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <exception>
#include <string_view>

#include "core/number_text.h"
#include "core/thread.h"

namespace dts::fleet::hub {
namespace {

using database::Database;

constexpr int kLongestWaitMs = 200;  // until a stop is noticed
constexpr int kSlowestPeerMs = 1000;
constexpr int kMostReads = 4;  // of one request, each within a second
constexpr std::size_t kMostRequestBytes = 4096;

/// One family of Prometheus' text format. Label values are names of clinics, which need no escapes.
class Family {
 public:
  Family(std::string& text, std::string name, const char* type, const char* help) : text_(text), name_(std::move(name)) {
    text_ += "# HELP " + name_ + " " + help + "\n# TYPE " + name_ + " " + type + "\n";
  }
  void add(double value, const std::string& clinic = {}) {
    text_ += name_ + (clinic.empty() ? "" : "{clinic=\"" + clinic + "\"}") + " " + core::number_text(value) + "\n";
  }

 private:
  std::string& text_;
  std::string name_;
};

void add_one(std::string& text, const char* name, const char* type, const char* help, double value) {
  Family(text, name, type, help).add(value);
}

struct ClinicFamily {
  const char* name;
  const char* help;
  std::size_t column;
};
constexpr std::array<ClinicFamily, 7> kClinicFamilies{
    {{"dts_hub_clinic_beat_age_seconds", "Time since the clinic reported last", 1},
     {"dts_hub_clinic_backlog_files", "Files that the clinic has not delivered", 2},
     {"dts_hub_clinic_backlog_bytes", "Bytes that the clinic has not delivered", 3},
     {"dts_hub_clinic_held_files", "Files of the clinic that are not what was recorded", 4},
     {"dts_hub_clinic_clock_offset_seconds", "Clock of the clinic minus the clock of the hub", 5},
     {"dts_hub_clinic_has_daemon", "1 if dtsd of the clinic answers", 6},
     {"dts_hub_clinic_quota_ratio",
      "Largest used part of the limits of sessions, recordings, rows and erasures; near 1 the hub rejects some", 7}}};

}  // namespace

std::string metrics_text(const HubState& hub, Database& database) {
  const IngestCounts& counts = hub.counts;
  const DeskCounts& letters = hub.letters;
  std::string text;
  const auto number = [](std::uint64_t value) { return static_cast<double>(value); };
  add_one(text, "dts_hub_received_bytes_total", "counter", "Bytes of recordings received", number(counts.bytes_total));
  add_one(text, "dts_hub_receipts_total", "counter", "Recordings stored by this hub", number(counts.receipts_total));
  add_one(text, "dts_hub_torn_uploads_total", "counter", "Uploads whose content was not the offered one", number(counts.torn_total));
  add_one(text, "dts_hub_later_answers_total", "counter", "Requests that the hub could not serve at that time", number(counts.later_total));
  add_one(text, "dts_hub_uploads", "gauge", "Recordings that are not whole yet", number(counts.uploads));
  add_one(text, "dts_hub_staged_bytes", "gauge", "Bytes of recordings that are not whole yet", number(counts.staged_bytes));
  add_one(text, "dts_hub_letters_total", "counter", "Messages of clinics", number(letters.letters_total));
  add_one(text, "dts_hub_rejected_letters_total", "counter", "Messages without a valid clinic or reply subject",
          number(letters.rejected_total));
  add_one(text, "dts_hub_dropped_letters_total", "counter", "Messages that a full queue dropped", number(letters.dropped_total));
  add_one(text, "dts_hub_store_used_ratio", "gauge", "Used part of the store", hub.store.used_percent() / 100.0);
  add_one(text, "dts_hub_store_free_bytes", "gauge", "Free bytes of the store", number(hub.store.free_bytes()));
  add_one(text, "dts_hub_nats_connected", "gauge", "1 if there is a connection to nats-server", hub.is_connected ? 1.0 : 0.0);
  if (!hub.slowed.empty()) {
    Family family(text, "dts_hub_clinic_slowed_messages_total", "counter", "Messages that were more than the quota of the clinic");
    for (const auto& [clinic, slowed] : hub.slowed) family.add(number(slowed), clinic);
  }
  const auto rows = database.run(
      "SELECT id, extract(epoch FROM now() - at)::float8, backlog_files::float8, backlog_bytes::float8, held_files::float8, "
      "clock_offset_s, "
      "has_daemon::int::float8, (SELECT greatest(sum(sessions) / $1::float8, sum(recordings) / $2::float8, sum(rows) / $3::float8, "
      "sum(erased) / $4::float8) FROM row_count c WHERE c.clinic = clinic.id) FROM clinic LEFT JOIN beat ON beat.clinic = id "
      "WHERE state = 'active' ORDER BY id",
      {hub.quota.sessions, hub.quota.recordings, hub.quota.rows, hub.quota.erased_sessions});
  add_one(text, "dts_hub_database_up", "gauge", "1 if PostgreSQL answers", rows ? 1.0 : 0.0);
  if (const auto left = database.run("SELECT count(*) FROM erased_file")) {
    add_one(text, "dts_hub_left_recordings", "gauge", "Recordings of erased sessions that could not be removed yet",
            left->number(0, 0).value_or(0.0));
  }
  if (!rows || rows->empty()) return text;
  for (const ClinicFamily& described : kClinicFamilies) {
    Family family(text, described.name, "gauge", described.help);
    for (std::size_t row = 0; row < rows->size(); ++row) {
      if (!rows->is_null(row, described.column)) family.add(rows->number(row, described.column).value_or(0.0), rows->text(row, 0));
    }
  }
  return text;
}

core::Result<std::unique_ptr<MetricsListener>> MetricsListener::open(const std::string& address, std::uint16_t port,
                                                                     std::function<std::string()> text) {
  const std::string where = address + ":" + std::to_string(port);
  sockaddr_in bound{};
  bound.sin_family = AF_INET;
  bound.sin_port = htons(port);
  const int opened = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  socklen_t size = sizeof bound;
  if (opened < 0 || ::inet_pton(AF_INET, address.c_str(), &bound.sin_addr) != 1 ||
      ::setsockopt(opened, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::bind(opened, reinterpret_cast<const sockaddr*>(&bound), sizeof bound) != 0 || ::listen(opened, 8) != 0 ||
      ::getsockname(opened, reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    const int error = errno;
    if (opened >= 0) ::close(opened);
    return core::fail_errno(error, "cannot listen on " + where, "choose another address in [metrics] listen");
  }
  std::unique_ptr<MetricsListener> listener(new MetricsListener(opened, ntohs(bound.sin_port), std::move(text)));
  listener->thread_ = std::jthread([raw = listener.get()](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("metrics", {}));
    raw->serve(stop);
  });
  return listener;
}

MetricsListener::MetricsListener(int socket, std::uint16_t port, std::function<std::string()> text)
    : socket_(socket), port_(port), text_(std::move(text)) {}

MetricsListener::~MetricsListener() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  ::close(socket_);
}

void MetricsListener::serve(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    pollfd item{.fd = socket_, .events = POLLIN, .revents = 0};
    if (::poll(&item, 1, kLongestWaitMs) <= 0) continue;
    const int peer = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (peer < 0) continue;
    const timeval limit{.tv_sec = kSlowestPeerMs / 1000, .tv_usec = 0};
    static_cast<void>(::setsockopt(peer, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit));
    answer(peer);
    ::close(peer);
  }
}

void MetricsListener::answer(int peer) const try {
  std::array<char, kMostRequestBytes> buffer{};
  std::size_t size = 0;
  std::string_view request;
  for (int turn = 0; request.find("\r\n\r\n") == std::string_view::npos; ++turn) {
    pollfd item{.fd = peer, .events = POLLIN, .revents = 0};
    if (turn == kMostReads || size == buffer.size() || ::poll(&item, 1, kSlowestPeerMs) <= 0) return;
    const ssize_t got = ::recv(peer, buffer.data() + size, buffer.size() - size, 0);
    if (got <= 0) return;
    size += static_cast<std::size_t>(got);
    request = {buffer.data(), size};
  }
  const bool is_known = request.starts_with("GET /metrics ");
  const std::string body = is_known ? text_() : "not found: GET /metrics\n";
  const std::string head =
      std::string("HTTP/1.1 ") + (is_known ? "200 OK" : "404 Not Found") +
      "\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\nConnection: close\r\nContent-Length: " + std::to_string(body.size()) +
      "\r\n\r\n";
  for (std::string_view rest : {std::string_view(head), std::string_view(body)}) {
    while (!rest.empty()) {
      const ssize_t sent = ::send(peer, rest.data(), rest.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;
      rest.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
} catch (const std::exception&) {  // no memory left: this scrape fails
}

}  // namespace dts::fleet::hub
