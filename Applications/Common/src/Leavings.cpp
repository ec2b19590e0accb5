// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Leavings.h"
#include "Explica/Core/Folders.h"

#include <algorithm>
#include <mutex>
#include <vector>

namespace explica::app {
namespace {

struct Noted {
  std::recursive_mutex mutex;  // memory may end while a path is noted
  std::vector<std::filesystem::path> paths;
};

Noted& noted() {
  static auto* all = new Noted;  // outlives every thread that may still ask
  return *all;
}

}  // namespace

void noteLeaving(const std::filesystem::path& path) {
  const std::lock_guard<std::recursive_mutex> guard(noted().mutex);
  noted().paths.push_back(path);
}

void forgetLeaving(const std::filesystem::path& path) {
  const std::lock_guard<std::recursive_mutex> guard(noted().mutex);
  auto& paths = noted().paths;
  const auto found = std::find(paths.begin(), paths.end(), path);
  if (found != paths.end()) paths.erase(found);
}

void removeLeavings() {
  constexpr int kAttempts = 5;  // other threads may still be writing into a stage
  const std::lock_guard<std::recursive_mutex> guard(noted().mutex);
  // Those noted last lie within those noted first: a stage goes before its lock.
  for (auto path = noted().paths.rbegin(); path != noted().paths.rend(); ++path) {
    std::error_code fault;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      std::filesystem::remove_all(*path, fault);
      if (!fault && !isThere(*path)) break;
    }
  }
  noted().paths.clear();
}

}  // namespace explica::app
