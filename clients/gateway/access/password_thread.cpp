// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/password_thread.h"

#include <pthread.h>

#include <boost/asio/post.hpp>
#include <utility>

namespace dts::gateway {

PasswordThread::PasswordThread(boost::asio::io_context& io, IsPassword is_password)
    : io_(io), is_password_(std::move(is_password)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void PasswordThread::compare(std::string hash, Secret password, Compared compared) {
  auto job = std::make_unique<Job>(Job{std::move(hash), std::move(password), std::move(compared)});
  {
    const std::scoped_lock lock(mutex_);
    job_ = std::move(job);
  }
  changed_.notify_one();
}

void PasswordThread::run(const std::stop_token& stop) {
  ::pthread_setname_np(::pthread_self(), "password");
  // Copied here, while the object certainly exists: posted work may outlive it.
  const std::weak_ptr<bool> is_alive = is_alive_;
  while (true) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [this] { return job_ != nullptr; })) return;
    const std::unique_ptr<Job> job = std::move(job_);
    lock.unlock();
    const bool is_right = is_password_(job->hash, job->password);
    boost::asio::post(io_, [is_alive, is_right, compared = std::move(job->compared)] {
      if (!is_alive.expired()) compared(is_right);
    });
  }
}

}  // namespace dts::gateway
