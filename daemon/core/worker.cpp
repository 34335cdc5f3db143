// SPDX-License-Identifier: Apache-2.0
#include "core/worker.h"

#include "core/thread.h"

namespace dts::core {

Worker::Worker(std::string name)
    : thread_([this, name = std::move(name)](const std::stop_token& stop) {
        static_cast<void>(configure_this_thread(name, {}));
        work(stop);
      }) {}

Worker::~Worker() {
  thread_.request_stop();
  thread_.join();
}

void Worker::post(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  has_task_.notify_one();
}

void Worker::work(const std::stop_token& stop) {
  while (true) {
    std::function<void()> task;
    {
      std::unique_lock lock(mutex_);
      if (!has_task_.wait(lock, stop, [this] { return !tasks_.empty(); }) || stop.stop_requested()) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task();
  }
}

}  // namespace dts::core
