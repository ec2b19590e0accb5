// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StateFile.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace {

namespace fs = std::filesystem;
using explica::IOError;
using explica::StateReader;
using explica::StateWriter;
using Plane = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

class StateFile : public testing::Test {
 protected:
  StateFile()
      : path_(fs::temp_directory_path() / ("explica-state-" + std::to_string(::getpid()))) {}
  ~StateFile() override { fs::remove(path_); }

  void write() const {
    StateWriter w;
    w.number(-0.1);
    w.count(3);
    w.numbers({1.5, 2.5});
    w.indices({7, -1});
    w.rows(Plane(Plane::Constant(3, 2, 0.25)));
    w.commit(path_, "Magic1\n");
  }
  fs::path path_;
};

TEST_F(StateFile, GivesBackEveryBit) {
  write();
  StateReader r(path_, "Magic1\n", "a test");
  EXPECT_EQ(r.number(), -0.1);
  EXPECT_EQ(r.count(), 3);
  EXPECT_EQ(r.numbers(), (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(r.indices(), (std::vector<std::int32_t>{7, -1}));
  EXPECT_FALSE(r.atEnd());
  EXPECT_EQ(r.rows<Plane>(), Plane(Plane::Constant(3, 2, 0.25)));
  EXPECT_TRUE(r.atEnd());
  EXPECT_THROW((void)r.number(), IOError);  // beyond the end
}

TEST_F(StateFile, RefusesAnotherFormatAndEveryChangedByte) {
  EXPECT_THROW(StateReader(path_, "Magic1\n", "a test"), IOError);  // absent
  write();
  EXPECT_THROW(StateReader(path_, "Magic2\n", "a test"), IOError);
  std::ifstream in(path_, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    std::string changed = bytes;
    changed[n] = static_cast<char>(changed[n] ^ 1);
    std::ofstream(path_, std::ios::binary) << changed;
    EXPECT_THROW(StateReader(path_, "Magic1\n", "a test"), IOError) << n;
  }
}

}  // namespace
