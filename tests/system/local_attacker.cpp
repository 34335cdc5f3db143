// SPDX-License-Identifier: Apache-2.0
// A client of the local data socket that means ill: local_attacker SOCKET ATTACK SECONDS. A program of its own, because the daemon counts
// the connections of a process. Prints how often it connected, and how many bytes it sent.
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "dts/zmtp/zmtp.h"

namespace {

using Clock = std::chrono::steady_clock;
namespace zmtp = dts::zmtp;

struct Task {
  std::string path;
  Clock::time_point end;
  unsigned long connections = 0;
  unsigned long bytes = 0;
  [[nodiscard]] bool is_over() const { return Clock::now() >= end; }
};

std::string frame(const std::string& body, bool has_more = false) {
  std::string bytes;
  zmtp::append_frame(bytes, body, has_more);
  return bytes;
}

std::string opening() {
  std::string bytes = zmtp::greeting();
  zmtp::append_ready(bytes, "SUB");
  return bytes;
}

class Connection {
 public:
  explicit Connection(Task& task) : task_(task), socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    task.path.copy(address.sun_path, sizeof address.sun_path - 1);
    is_connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    if (is_connected_) ++task_.connections;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  [[nodiscard]] bool is_connected() const noexcept { return is_connected_; }

  /// Sends everything, in pieces of `piece` bytes. Returns false if the daemon has closed the connection or the time is over.
  bool send(std::string_view bytes, std::size_t piece = std::string_view::npos) {
    while (!bytes.empty() && is_connected_ && !task_.is_over()) {
      const ssize_t sent = ::send(socket_, bytes.data(), std::min(bytes.size(), piece), MSG_NOSIGNAL);
      if (sent > 0) {
        task_.bytes += static_cast<unsigned long>(sent);
        bytes.remove_prefix(static_cast<std::size_t>(sent));
      } else if (errno == EAGAIN) {
        pollfd waited{.fd = socket_, .events = POLLOUT, .revents = 0};
        ::poll(&waited, 1, 20);
      } else {
        is_connected_ = false;
      }
    }
    return bytes.empty();
  }
  /// Returns false if the daemon has closed the connection.
  [[nodiscard]] bool read(std::size_t most) {
    std::string bytes(most, '\0');
    const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
    return got > 0 || (got < 0 && errno == EAGAIN);
  }
  /// Returns whether the daemon has closed the connection, without reading what it sent.
  [[nodiscard]] bool is_closed() const {
    pollfd waited{.fd = socket_, .events = POLLRDHUP, .revents = 0};
    return !is_connected_ || ::poll(&waited, 1, 0) == 1;
  }

 private:
  Task& task_;
  int socket_;
  bool is_connected_ = false;
};

void pause_ms(int time) { ::poll(nullptr, 0, time); }

/// Connects again and again, and sends what `next` returns until the daemon ends the connection.
void send_forever(Task& task, const std::string& first, const std::function<std::string()>& next, std::size_t piece = std::string::npos) {
  while (!task.is_over()) {
    Connection connection(task);
    if (!connection.send(first, piece)) pause_ms(1);
    while (connection.send(next(), piece) && !task.is_over()) static_cast<void>(connection.read(65536));
  }
}

/// Keeps `count` connections, each of which sent `bytes`.
void keep(Task& task, std::size_t count, const std::function<std::string()>& bytes, std::size_t read_bytes = 0) {
  std::vector<std::unique_ptr<Connection>> connections;
  while (!task.is_over()) {
    std::erase_if(connections, [](const auto& connection) { return connection->is_closed(); });
    while (connections.size() < count && !task.is_over()) {
      auto added = std::make_unique<Connection>(task);
      if (!added->is_connected()) break;
      added->send(bytes());
      connections.push_back(std::move(added));
    }
    for (const auto& connection : connections) {
      if (read_bytes > 0) static_cast<void>(connection->read(read_bytes));
    }
    pause_ms(2);
  }
}

/// Opens up to `count` connections and drops them, again and again.
void come_and_go(Task& task, std::size_t count) {
  while (!task.is_over()) {
    std::vector<std::unique_ptr<Connection>> connections;
    while (connections.size() < count && !task.is_over()) {
      connections.push_back(std::make_unique<Connection>(task));
      if (!connections.back()->is_connected()) pause_ms(1);
    }
    pause_ms(20);
  }
}

std::string numbered_subscriptions(unsigned& number, std::size_t length) {
  std::string bytes;
  while (bytes.size() < 60'000) {
    std::string prefix = std::to_string(++number);
    prefix.resize(std::max(prefix.size(), length), 'x');
    bytes += frame("\1" + prefix);
  }
  return bytes;
}

std::string noise(std::mt19937& random) {
  std::string bytes(4096, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

int run(Task& task, const std::string& attack) {
  unsigned number = 0;
  std::mt19937 random(7);
  const std::map<std::string, std::function<void()>> attacks{
      {"subscriptions", [&] { send_forever(task, opening(), [&] { return numbered_subscriptions(number, 1); }); }},
      {"long-subscriptions", [&] { send_forever(task, opening(), [&] { return numbered_subscriptions(number, 500); }); }},
      // The same 256 prefixes again and again, which is allowed.
      {"changes",
       [&] {
         send_forever(task, opening(), [&] {
           std::string bytes;
           for (unsigned change = 0; change < 1000; ++change) {
             const std::string prefix = "floor/" + std::to_string(++number % 250);
             bytes += frame("\1" + prefix) + frame(std::string(1, '\0') + prefix);
           }
           return bytes;
         });
       }},
      {"multi-part",
       [&] {
         std::string frames;
         while (frames.size() < 60'000) frames += frame("\1floor/", true);
         send_forever(task, opening(), [&] { return frames; });
       }},
      {"one-byte",
       [&] {
         std::string ping;
         zmtp::append_command(ping, "PING", std::string("\0\x0a", 2) + "now");
         send_forever(
             task, opening() + frame("\1floor/"), [&] { return ping; }, 1);
       }},
      {"connections", [&] { come_and_go(task, 250); }},
      {"half-open",
       [&] {
         keep(task, 64, [&] {
           constexpr std::size_t kCuts[] = {0, 64, 70};
           return opening().substr(0, kCuts[++number % std::size(kCuts)]);
         });
       }},
      {"idle", [&] { keep(task, 64, [] { return opening(); }); }},
      {"all-subscriptions",  // as many and as long ones as allowed
       [&] {
         keep(
             task, 64,
             [&] {
               std::string bytes = opening();
               for (int each = 0; each < 256; ++each) bytes += frame("\1" + std::to_string(++number) + std::string(190, 'x'));
               return bytes;
             },
             65536);
       }},
      {"reading",
       [&] {
         keep(
             task, 64, [] { return opening() + frame("\1"); }, 65536);
       }},
      {"never-reading", [&] { keep(task, 64, [] { return opening() + frame("\1"); }); }},
      {"sipping",
       [&] {
         keep(
             task, 64, [] { return opening() + frame("\1"); }, 100);
       }},
      {"huge-frames",
       [&] {
         const std::string header = std::string("\x02\x80", 2) + std::string(7, '\0');
         send_forever(task, opening() + header, [] { return std::string(60'000, 'x'); });
       }},
      {"noise", [&] { send_forever(task, ++number % 2 == 0 ? opening() : "", [&] { return noise(random); }); }},
      {"noise-behind-the-handshake", [&] { send_forever(task, opening(), [&] { return noise(random); }); }},
  };
  const auto found = attacks.find(attack);
  if (found == attacks.end()) return 2;
  found->second();
  std::printf("%lu connections, %lu bytes\n", task.connections, task.bytes);
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return 2;
  const auto length = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::strtod(arguments[3], nullptr)));
  Task task{.path = arguments[1], .end = Clock::now() + length};
  return run(task, arguments[2]);
}
