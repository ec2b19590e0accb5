// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <sys/mount.h>

#include <filesystem>
#include <string>
#include <utility>

namespace explica::testing {

/// A small file system of its own, while this object lives.
class SmallDisk {
 public:
  /// @param size  in tmpfs's words: "64k"
  SmallDisk(std::filesystem::path place, const std::string& size) : place_(std::move(place)) {
    std::filesystem::create_directories(place_);
    mounted_ = mount("tmpfs", place_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(place_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  /// False where this user may not mount one.
  [[nodiscard]] bool mounted() const { return mounted_; }
  void resize(const std::string& size) const {
    ASSERT_EQ(mount("tmpfs", place_.c_str(), "tmpfs", MS_REMOUNT, ("size=" + size).c_str()), 0);
  }

 private:
  std::filesystem::path place_;
  bool mounted_ = false;
};

}  // namespace explica::testing
