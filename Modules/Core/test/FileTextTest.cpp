// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/FileText.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;
using explica::fileText;
using explica::IOError;

class FileText : public testing::Test {
 protected:
  FileText() : folder_(fs::temp_directory_path() / ("explica-text-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~FileText() override { fs::remove_all(folder_); }

  static std::string complaint(const fs::path& path) {
    try {
      static_cast<void>(fileText(path, 10));
    } catch (const IOError& fault) {
      return fault.what();
    }
    return "accepted";
  }
  fs::path folder_;
};

TEST_F(FileText, IsEveryByteOfAFile) {
  const std::string bytes("a\0b\r\n\xff", 6);
  std::ofstream(folder_ / "a", std::ios::binary) << bytes;
  EXPECT_EQ(fileText(folder_ / "a"), bytes);
  std::ofstream(folder_ / "empty").flush();
  EXPECT_EQ(fileText(folder_ / "empty"), "");
}

TEST_F(FileText, RefusesWhatIsNoFileWithoutWaiting) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);  // nobody will ever write to it
  EXPECT_EQ(complaint(folder_ / "pipe"), (folder_ / "pipe").string() + ": is not a regular file");
  EXPECT_EQ(complaint("/dev/zero"), "/dev/zero: is not a regular file");
  EXPECT_EQ(complaint(folder_), folder_.string() + ": cannot be read (it is a folder)");
  EXPECT_EQ(complaint(folder_ / "none"),
            (folder_ / "none").string() + ": cannot be read (No such file or directory)");
}

TEST_F(FileText, IsBounded) {
  std::ofstream(folder_ / "a") << "12345678901";
  EXPECT_EQ(complaint(folder_ / "a"),
            (folder_ / "a").string() + ": has 11 bytes; a file of this kind has 10 at most");
}

}  // namespace
