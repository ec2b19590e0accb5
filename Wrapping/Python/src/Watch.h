// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/StopScope.h"

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace explica::python {

namespace py = pybind11;

/// Runs work() without Python's lock; for work that has no monitor.
template <class Work>
auto unlocked(const Work& work) {
  const py::gil_scoped_release released;
  return work();
}

/// Lets long work run without Python's lock while Python stays in charge: progress goes to a
/// callback (fraction, activity), which may return False to stop; Ctrl-C stops at the next
/// consistent state and is raised afterwards; warnings become Python warnings.
class Watch {
 public:
  explicit Watch(py::object callback) : callback_(std::move(callback)) {}
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// Runs work(monitor) without the lock, then raises what happened in callbacks meanwhile.
  template <class Work>
  auto run(const Work& work) {
    const Monitor monitor = makeMonitor();
    try {
      auto result = unlocked([&] { return work(monitor); });
      raisePending();
      return result;
    } catch (const Interrupted&) {  // in work that is worth nothing half done
      raisePending();
      PyErr_SetNone(PyExc_KeyboardInterrupt);
      throw py::error_already_set();
    }
  }

 private:
  Monitor makeMonitor() {
    Monitor monitor;
    if (!callback_.is_none()) {
      monitor.onProgress = [this](double fraction, std::string_view activity) {
        const py::gil_scoped_acquire locked;
        guard([&] {
          const py::object answer = callback_(fraction, std::string(activity));
          if (answer.is(py::bool_(false))) stop_ = true;
        });
      };
    }
    monitor.onWarning = [this](const std::string& message) {
      const std::lock_guard<std::mutex> hold(mutex_);
      warnings_.push_back(message);
    };
    monitor.stopWanted = [this] {
      const std::unique_lock<std::mutex> alone(asking_, std::try_to_lock);
      if (!alone) return stop_.load();  // another thread is asking
      const auto now = std::chrono::steady_clock::now();
      if (!stop_ && now - checked_ > kSignalInterval) {
        checked_ = now;
        const py::gil_scoped_acquire locked;
        guard([] {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        });
      }
      return stop_.load();
    };
    return monitor;
  }

  template <class Call>
  void guard(const Call& call) {
    if (pending_) return;
    try {
      call();
    } catch (py::error_already_set& error) {
      pending_ = std::make_unique<py::error_already_set>(std::move(error));
      stop_ = true;
    }
  }

  void raisePending() {
    for (const std::string& warning : warnings_) {
      if (PyErr_WarnEx(PyExc_RuntimeWarning, warning.c_str(), 2) != 0)
        throw py::error_already_set();
    }
    if (pending_) throw py::error_already_set(std::move(*pending_));
  }

  static constexpr std::chrono::milliseconds kSignalInterval{50};  // unnoticed by a person
  py::object callback_;
  std::atomic<bool> stop_ = false;
  std::mutex asking_;
  std::chrono::steady_clock::time_point checked_{};
  std::mutex mutex_;
  std::vector<std::string> warnings_;
  std::unique_ptr<py::error_already_set> pending_;
};

}  // namespace explica::python
