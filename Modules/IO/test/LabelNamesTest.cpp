// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/LabelNames.h"

#include "Explica/Core/Errors.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

namespace explica::io {
namespace {

TEST(LabelNames, BidsTablesAndPlainListsAreRead) {
  const TemporaryFolder folder;
  putContent(folder / "sub-01_atlas-AAL_dseg.tsv",
             "index\tabbreviation\tname\n1\tPL\tleft precentral\n2\tPR\tright precentral\n");
  const auto legend = findLegend(folder / "sub-01_atlas-AAL_dseg.nii.gz");
  ASSERT_TRUE(legend.has_value());
  const LabelNames bids = readLabelNames(*legend);
  EXPECT_EQ(bids.size(), 2u);
  EXPECT_EQ(bids.at(2), "right precentral");

  putContent(folder / "aal.nii.txt", "# AAL\n1 Precentral_L 2001\r\n\n2 Precentral_R 2002\r\n");
  const LabelNames plain = readLabelNames(*findLegend(folder / "aal.nii.gz"));
  EXPECT_EQ(plain.at(1), "Precentral_L");
  EXPECT_EQ(plain.size(), 2u);
  EXPECT_FALSE(findLegend(folder / "other.nii.gz").has_value());
}

TEST(LabelNames, ALineWithoutNameIsNamed) {
  const TemporaryFolder folder;
  putContent(folder / "a.txt", "1 inside\n2\n");
  try {
    (void)readLabelNames(folder / "a.txt");
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_NE(std::string(fault.what()).find("a.txt': line 2"), std::string::npos) << fault.what();
  }
  EXPECT_THROW((void)readLabelNames(folder / "absent.txt"), IOError);
}

TEST(LabelNames, FreeSurfersRegionsHaveTheirNumbers) {  // FreeSurferColorLUT.txt
  EXPECT_EQ(freeSurferRegion(1001), "bankssts");
  EXPECT_EQ(freeSurferRegion(2021), "pericalcarine");
  EXPECT_EQ(freeSurferRegion(1024), "precentral");
  EXPECT_EQ(freeSurferRegion(2025), "precuneus");
  EXPECT_EQ(freeSurferRegion(1035), "insula");
  for (const Label label : {0, 3, 42, 1000, 1036, 3001, -1001}) {
    EXPECT_EQ(freeSurferRegion(label), "") << label;
  }
}

}  // namespace
}  // namespace explica::io
