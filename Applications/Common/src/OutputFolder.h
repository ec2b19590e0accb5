// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace explica::app {

/// How an output folder may be used.
struct OutputRules {
  bool mayHoldFiles = false;    ///< --force or --resume
  bool replaceEarlier = false;  ///< --force: an earlier run's outputs go when the new ones come
  bool inPlace = false;         ///< no staging: files go straight into the folder
  bool checkOnly = false;       ///< dry run: look, touch nothing
  std::string command;          ///< for the lock
  std::string share;            ///< of the folder's work that this run does alone; empty: all
};

/// Removes the outputs that the record in `folder` lists and that are still as it lists them, the
/// record, and the folder if nothing else is in it.  Names in `keep` stay.
void removeRecorded(const std::filesystem::path& folder, const std::vector<std::string>& keep = {});

/// Before any work: whether a folder is there, or can be made, and may be written.
/// @throws EnvironmentError  it cannot
void requirePlaceFor(const std::filesystem::path& folder);

/// The results of one run, which appear together or not at all.
///
/// Files are written into a hidden staging folder: beside the output folder if that does not exist
/// (and then one rename makes it appear whole), inside it otherwise (and then files are renamed one
/// by one, the record last).  A lock file names the process, so that a second run into the same
/// folder, or on the same share of its work, refuses; a lock whose process is gone, or whose other
/// host has been silent for long, is taken over.
class OutputFolder {
 public:
  /// @throws UsageError        not empty, or a file
  /// @throws EnvironmentError  cannot be made, or another run is at work in it
  OutputFolder(std::filesystem::path folder, const OutputRules& rules,
               const std::function<void(const std::string&)>& warn);
  /// Takes back everything that was not published.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write a file now; makes the folders in `name`.
  [[nodiscard]] std::filesystem::path place(const std::string& name);
  /// Names of the files placed that exist, sorted.
  [[nodiscard]] std::vector<std::string> files() const;
  /// Makes the files appear, `last` after all others.
  void publish(const std::string& last);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  void acquireLock(const OutputRules& rules, const std::function<void(const std::string&)>& warn);
  void releaseLock();

  std::filesystem::path folder_, stage_, lock_;
  std::vector<std::filesystem::path> madeFolders_;  ///< in order of creation
  std::vector<std::string> placed_;
  bool existed_ = false;
  bool inPlace_ = false;
  bool replaceEarlier_ = false;
  bool published_ = false;
  bool locked_ = false;
  std::thread heartbeat_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
};

}  // namespace explica::app
