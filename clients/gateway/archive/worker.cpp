// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/worker.h"

#include <boost/asio/post.hpp>
#include <utility>

#include "core/thread.h"

namespace dts::gateway {

Worker::Worker(boost::asio::io_context& io, std::size_t threads) : io_(io) {
  for (std::size_t k = 0; k < threads; ++k) threads_.emplace_back([this](const std::stop_token& stop) { run(stop); });
}

bool Worker::submit(Work work) {
  if (not_done_ >= kMostWaiting + threads_.size()) return false;
  ++not_done_;
  {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  changed_.notify_one();
  return true;
}

void Worker::run(const std::stop_token& stop) {
  static_cast<void>(core::configure_this_thread("archive", {}));  // sets only the thread's name
  const std::weak_ptr<bool> is_alive = is_alive_;
  while (true) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [this] { return !waiting_.empty(); }) || stop.stop_requested()) return;
    Work work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    Answer answer = work(stop);
    work = nullptr;  // releases what the work holds before the result is passed on
    boost::asio::post(io_, [this, is_alive, answer = std::move(answer)] {
      if (is_alive.expired()) return;
      --not_done_;
      answer();
    });
  }
}

}  // namespace dts::gateway
