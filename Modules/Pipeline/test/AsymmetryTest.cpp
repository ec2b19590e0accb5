// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/Asymmetry.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <string>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

class Asymmetry : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  fs::path folder_ = fs::temp_directory_path() / ("explica-asymmetry-" + std::to_string(getpid()));
};

constexpr const char* kHead = "index\tname\tarea_white_mm2\tthickness_mean_mm\n";

TEST_F(Asymmetry, IsTheDifferenceOverTheMeanOfBothSides) {
  const fs::path left = file("left.tsv", std::string(kHead) + "1\tctx-lh-insula\t300\t3\n");
  const fs::path right = file("right.tsv", std::string(kHead) + "2\tctx-rh-insula\t500\t2\n");
  EXPECT_EQ(asymmetryTable(left, right),
            "name\tthickness_left_mm\tthickness_right_mm\tthickness_asymmetry\tarea_left_mm2\t"
            "area_right_mm2\tarea_asymmetry\n"
            "insula\t3\t2\t0.4\t300\t500\t-0.5\n");
}

TEST_F(Asymmetry, LeavesOutWhatOneSideLacksAndSaysWhatHasNoNumber) {
  const fs::path left =
      file("left.tsv", std::string(kHead) + "1\tCuneus_L\t100\tn/a\n3\tHeschl_L\t10\t2\n");
  const fs::path right = file("right.tsv", std::string(kHead) + "2\tCuneus_R\t100\t2.5\n");
  const std::string table = asymmetryTable(left, right);
  EXPECT_NE(table.find("Cuneus\tn/a\t2.5\tn/a\t100\t100\t0\n"), std::string::npos) << table;
  EXPECT_EQ(table.find("Heschl"), std::string::npos);
}

TEST_F(Asymmetry, TablesOfAnotherKindAreRefusedByName) {
  const fs::path good = file("left.tsv", kHead);
  EXPECT_THROW(static_cast<void>(asymmetryTable(good, folder_ / "absent.tsv")), IOError);
  EXPECT_THROW(static_cast<void>(asymmetryTable(good, file("other.tsv", "a\tb\n"))), IOError);
}

}  // namespace
}  // namespace explica::pipeline
