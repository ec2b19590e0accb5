// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/IO/PolygonFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using namespace explica;

Positions2 somePolygon() {
  Positions2 polygon(5, 2);
  polygon << 0, 0, 1.0 / 3, -0.1, 2, 1e-17, 1.5, 2, -1e7, 0.7;
  return polygon;
}

TEST(Polygon, CsvAndVtpGiveBackEveryDouble) {
  const TemporaryFolder folder;
  const io::VertexMap map{"flux", "", Eigen::VectorXd::LinSpaced(5, 0, 1)};
  io::writePolygonCsv(folder / "a.csv", somePolygon());
  EXPECT_EQ(io::readPolygon(folder / "a.csv"), somePolygon());
  EXPECT_TRUE(contentOf(folder / "a.csv").starts_with("x,y\n0,0\n"));
  io::writePolygonVtp(folder / "a.vtp", somePolygon(), {map}, {map});
  EXPECT_EQ(io::readPolygon(folder / "a.vtp"), somePolygon());
  EXPECT_EQ(io::readVertexMaps(folder / "a.vtp").at(0).values, map.values);
}

TEST(Polygon, TextIsReadInItsUsualDialects) {
  const TemporaryFolder folder;
  Positions2 expected(3, 2);
  expected << 0, 0, 2, 0, 0, 1.5;
  for (const char* text : {"0,0\n2,0\n0,1.5\n", "X; Y; name\n0; 0; a\n2; 0; b\n0; 1.5; c\n",
                           "# pixels\r\n0 0\r\n2 0\r\n0\t1.5\r\n", "0 0\n\n+2 0\n0 1.5\n0 0\n",
                           "\"x\",\"y\"\n0,0\n2,0\n0,15e-1"}) {
    putContent(folder / "a.csv", text);
    EXPECT_EQ(io::readPolygon(folder / "a.csv"), expected) << text;
  }
}

TEST(Polygon, CellsOfVtkAreChainedToOneLoop) {
  const TemporaryFolder folder;
  const std::string head =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
      "0 0 5 1 0 5 1 1 5 0 1 5\n";
  Positions2 expected(4, 2);
  expected << 0, 0, 1, 0, 1, 1, 0, 1;
  for (const char* cells :
       {"LINES 1 6\n5 0 1 2 3 0\n", "POLYGONS 1 5\n4 0 1 2 3\n",
        "LINES 4 12\n2 0 1 2 3 0 2 2 1 2 2 3\n", "LINES 2 8\n3 0 1 2 3 2 3 0\n", ""}) {
    putContent(folder / "a.vtk", head + cells);
    const Positions2 read = io::readPolygon(folder / "a.vtk");
    ASSERT_EQ(read.rows(), 4) << cells;
    if (std::string(cells).starts_with("LINES 4")) continue;  // direction follows the first link
    EXPECT_EQ(read, expected) << cells;
  }
  struct Row {
    const char* cells;
    const char* words;
  };
  for (const Row& row :
       {Row{"LINES 1 5\n4 0 1 2 3\n", "open"}, Row{"LINES 2 6\n2 0 1 2 1 0\n", "holds 2 points"},
        Row{"LINES 4 12\n2 0 1 2 0 2 2 0 3 2 1 2\n", "branch"},
        Row{"LINES 1 6\n5 0 1 2 9 0\n", "names point 9"}}) {
    putContent(folder / "a.vtk", head + row.cells);
    const std::string complaint =
        complaintOf<InvalidInput>([&] { static_cast<void>(io::readPolygon(folder / "a.vtk")); });
    EXPECT_NE(complaint.find(row.words), std::string::npos) << row.cells << complaint;
  }
}

TEST(Polygon, BadTextIsNamedByItsLine) {
  const TemporaryFolder folder;
  for (const char* text : {"0,0\n1,0\nabc\n1,1\n", "0,0\n1\n1,1\n2,2\n"}) {
    putContent(folder / "a.csv", text);
    EXPECT_THROW(static_cast<void>(io::readPolygon(folder / "a.csv")), IOError) << text;
  }
  for (const char* text : {"0,0\n1,0\n", "0,0\n1,0\n1,nan\n"}) {
    putContent(folder / "a.csv", text);
    EXPECT_THROW(static_cast<void>(io::readPolygon(folder / "a.csv")), InvalidInput) << text;
  }
}

}  // namespace
