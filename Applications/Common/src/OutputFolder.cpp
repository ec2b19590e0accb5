// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "OutputFolder.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Record.h"
#include "Leavings.h"
#include "LockFile.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <set>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr const char* kLockName = ".explica-lock";

[[noreturn]] void cannot(const std::string& what, const fs::path& path, const std::string& cause) {
  throw EnvironmentError(path.string() + ": " + what + " (" + cause + ")");
}

}  // namespace

void removeRecorded(const fs::path& folder, const std::vector<std::string>& keep) {
  const fs::path record = folder / provenance::kRecordName;
  std::error_code ignored;
  if (!isThere(record)) return;
  std::set<fs::path> emptied;
  try {
    const Json earlier = provenance::readRecord(record);
    fs::remove(record);
    for (const Json& output : provenance::hashedOutputs(earlier)) {
      const std::string name = output["path"];
      const auto own = provenance::ownFile(folder, name);
      if (!own) continue;
      const fs::path& path = *own;
      if (path != record && path.filename() == provenance::kRecordName) continue;  // a step's own
      const bool ours = fs::is_regular_file(path, ignored) &&
                        provenance::digestOf(path).sha256 == output["sha256"];
      if (!ours || std::find(keep.begin(), keep.end(), name) != keep.end()) continue;
      fs::remove(path);
      emptied.insert(path.parent_path());
    }
  } catch (const IOError&) {
    fs::remove(record, ignored);  // damaged: it must not describe the new files
  }
  for (const fs::path& place : emptied) fs::remove(place, ignored);  // only if empty
  fs::remove(folder, ignored);
}

void requirePlaceFor(const fs::path& folder) {
  auto parent = fs::absolute(folder);
  while (!isThere(parent) && parent.has_relative_path()) parent = parent.parent_path();
  if (!isFolder(parent)) {
    cannot("the output folder cannot be made", folder, parent.string() + " is a file");
  }
  if (access(parent.c_str(), W_OK) != 0) {
    cannot("the output folder cannot be made", folder, std::strerror(errno));
  }
}

OutputFolder::OutputFolder(fs::path folder, const OutputRules& rules,
                           const std::function<void(const std::string&)>& warn)
    : folder_(std::move(folder)), inPlace_(rules.inPlace), replaceEarlier_(rules.replaceEarlier) {
  if (folder_.empty()) throw UsageError("--out is empty; it names a folder");
  if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "results/" is "results"
  std::error_code fault;
  if (fs::is_symlink(fs::symlink_status(folder_, fault))) {
    // The folder that is meant: a link must neither be replaced by results nor taken for a new
    // name.
    const fs::path meant = fs::canonical(folder_, fault);
    if (fault) {
      throw UsageError(folder_.string() + ": --out is a link to a place that does not exist");
    }
    folder_ = meant;
  }
  const auto status = fs::status(folder_, fault);
  existed_ = fs::exists(status);
  if (existed_ && !fs::is_directory(status)) {
    throw UsageError(folder_.string() + ": --out must be a folder, this is a file");
  }
  if (existed_ && !rules.mayHoldFiles) {
    fs::directory_iterator entries(folder_, fault);
    if (fault) cannot("the output folder cannot be read", folder_, fault.message());
    for (const auto& entry : entries) {
      const std::string name = entry.path().filename().string();
      if (name.rfind(".explica-", 0) == 0) continue;  // left by a run that was killed
      throw UsageError(folder_.string() + ": the output folder is not empty (it holds " + name +
                       "); give another --out, or --force to replace what is there");
    }
  }
  if (rules.checkOnly) {
    requirePlaceFor(folder_);
    published_ = true;
    return;
  }

  const fs::path absolute = fs::absolute(folder_);
  const bool inside = existed_ || inPlace_;
  std::vector<fs::path> missing;
  for (fs::path p = inside ? absolute : absolute.parent_path();
       !isThere(p) && p.has_relative_path(); p = p.parent_path()) {
    missing.push_back(p);
  }
  for (auto it = missing.rbegin(); it != missing.rend(); ++it) {
    if (mkdir(it->c_str(), 0777) != 0 && errno != EEXIST) {
      const std::string cause = std::strerror(errno);
      for (auto made = madeFolders_.rbegin(); made != madeFolders_.rend(); ++made) {
        fs::remove(*made, fault);
      }
      cannot("the output folder cannot be made", folder_, cause);
    }
    madeFolders_.push_back(*it);
  }
  const std::string name = absolute.filename().string();
  const std::string ownLock = rules.share.empty() ? kLockName : kLockName + ("-" + rules.share);
  lock_ = inside ? absolute / ownLock : absolute.parent_path() / ("." + name + kLockName);
  stage_ = inPlace_ ? absolute
           : inside ? absolute / ".explica-stage"
                    : absolute.parent_path() / ("." + name + ".explica-stage");
  try {
    acquireLock(rules, warn);
    if (!inPlace_) {
      noteLeaving(stage_);
      fs::remove_all(stage_);
      fs::create_directory(stage_);
    }
  } catch (const fs::filesystem_error& error) {
    releaseLock();
    cannot("the output folder cannot be used", folder_, error.code().message());
  } catch (...) {
    releaseLock();
    for (auto made = madeFolders_.rbegin(); made != madeFolders_.rend(); ++made) {
      fs::remove(*made, fault);
    }
    throw;
  }
}

void OutputFolder::acquireLock(const OutputRules& rules,
                               const std::function<void(const std::string&)>& warn) {
  for (int attempt = 0; attempt < 3; ++attempt) {
    const LockAttempt made = makeLock(lock_, ownLock(rules.command));
    locked_ = made.created;
    if (made.created) {
      noteLeaving(lock_);
      if (made.fault != 0) {
        cannot("the output folder cannot be written", folder_, std::strerror(made.fault));
      }
      heartbeat_ = std::thread([this] {
        std::unique_lock<std::mutex> guard(mutex_);
        while (!wake_.wait_for(guard, std::chrono::seconds(30), [this] { return stopping_; })) {
          std::error_code ignored;
          fs::last_write_time(lock_, fs::file_time_type::clock::now(), ignored);
        }
      });
      return;
    }
    if (made.fault != EEXIST) {
      cannot("the output folder cannot be written", folder_, std::strerror(made.fault));
    }
    const std::string holder = holderOf(lock_);
    if (!holder.empty()) {
      throw EnvironmentError(folder_.string() + ": in use by " + holder +
                             "; wait for it, or give another --out");
    }
    // Only one of several takers succeeds in moving the stale lock away.
    const fs::path aside = lock_.string() + "." + std::to_string(getpid());
    if (rename(lock_.c_str(), aside.c_str()) == 0) {
      unlink(aside.c_str());
      warn(folder_.string() + ": an earlier run was killed here; its unfinished files are removed");
    }
  }
  throw EnvironmentError(folder_.string() +
                         ": other runs contend for this folder; give another --out");
}

void OutputFolder::releaseLock() {
  if (heartbeat_.joinable()) {
    {
      const std::lock_guard<std::mutex> guard(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    heartbeat_.join();
  }
  if (locked_) {
    std::error_code ignored;
    fs::remove(lock_, ignored);
    forgetLeaving(lock_);
    locked_ = false;
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!published_ && !inPlace_ && !stage_.empty()) fs::remove_all(stage_, ignored);
  forgetLeaving(stage_);
  releaseLock();
  if (!published_) {
    for (auto made = madeFolders_.rbegin(); made != madeFolders_.rend(); ++made) {
      fs::remove(*made, ignored);  // only if empty
    }
  }
}

fs::path OutputFolder::place(const std::string& name) {
  if (!provenance::staysBelow(name)) {
    throw UsageError("'" + name + "' would be written outside the output folder");
  }
  fs::path path = stage_ / name;
  std::error_code fault;
  fs::create_directories(path.parent_path(), fault);
  if (fault) cannot("cannot be made", path.parent_path(), fault.message());
  if (std::find(placed_.begin(), placed_.end(), name) == placed_.end()) placed_.push_back(name);
  return path;
}

std::vector<std::string> OutputFolder::files() const {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& name : placed_) {
    if (fs::is_regular_file(stage_ / name, ignored)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void OutputFolder::publish(const std::string& last) {
  const auto names = files();
  try {
    if (inPlace_) {
      // Files are in place already.
    } else if (!existed_) {
      releaseLock();
      fs::rename(stage_, folder_);
      forgetLeaving(stage_);
    } else {
      if (replaceEarlier_) {
        removeRecorded(folder_, names);
      } else {
        fs::remove(folder_ / last);
      }
      for (const auto& name : names) {
        if (name == last) continue;
        fs::create_directories((folder_ / name).parent_path());
        fs::rename(stage_ / name, folder_ / name);
      }
      if (std::find(names.begin(), names.end(), last) != names.end()) {
        fs::rename(stage_ / last, folder_ / last);
      }
      fs::remove_all(stage_);
    }
  } catch (const fs::filesystem_error& error) {
    cannot("the results cannot be put in place", folder_, error.code().message());
  }
  published_ = true;
  releaseLock();
}

}  // namespace explica::app
