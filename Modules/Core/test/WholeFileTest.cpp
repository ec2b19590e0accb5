// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace {

namespace fs = std::filesystem;
using explica::EnvironmentError;
using explica::WholeFile;

std::string contentOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class WholeFileTest : public testing::Test {
 protected:
  WholeFileTest()
      : folder_(fs::temp_directory_path() / ("explica-whole-file-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~WholeFileTest() override { fs::remove_all(folder_); }
  [[nodiscard]] std::ptrdiff_t entries() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }
  fs::path folder_;
};

TEST_F(WholeFileTest, AppearsOnCommitOnly) {
  const fs::path path = folder_ / "a.txt";
  WholeFile file(path);
  file.write("first ");
  file.write("second");
  EXPECT_FALSE(fs::exists(path));
  file.commit();
  EXPECT_EQ(contentOf(path), "first second");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFileTest, KeepsTheOldFileAndLeavesNoTraceWhenAbandoned) {
  const fs::path path = folder_ / "a.txt";
  explica::writeTextFile(path, "old");
  {
    WholeFile file(path);
    file.write("new");
  }
  EXPECT_EQ(contentOf(path), "old");
  EXPECT_EQ(entries(), 1);
  explica::writeTextFile(path, "newer");
  EXPECT_EQ(contentOf(path), "newer");
}

TEST_F(WholeFileTest, NamesThePathWhenTheFolderIsMissingOrTheNameIsAFolder) {
  for (const fs::path& path : {folder_ / "missing" / "a.txt", folder_}) {
    try {
      explica::writeTextFile(path, "text");
      ADD_FAILURE() << path << " was written";
    } catch (const EnvironmentError& error) {
      EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    }
  }
}

TEST_F(WholeFileTest, LeavesNothingWhenTheDeviceTakesNoMore) {
  const fs::path path = folder_ / "large.bin";
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string message;
  try {
    explica::writeTextFile(path, std::string(100000, 'x'));
  } catch (const EnvironmentError& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find(path.string()), std::string::npos) << message;
  EXPECT_EQ(entries(), 0);
}

}  // namespace
