// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/ThesisTree.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Repulsion/AllPairs.h"
#include "Explica/Testing/Selections.h"

#include <gtest/gtest.h>

namespace explica::repulsion {
namespace {

using testing::everyVertex;

using List = std::vector<std::int32_t>;

/// [Thesis, figure 5.23]: nine faces in a row, each the neighbour of the next, so spaced that the
/// tree is the figure's.  Numbers are the figure's less one.
MergingTree figureTree() {
  const std::vector<double> at = {0, 1, 4, 5.2, 6.8, 10, 11.4, 15, 16.6};
  std::vector<Point> centroids;
  std::vector<List> neighbours(at.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    centroids.emplace_back(at[i], 0, 0);
    if (i > 0) neighbours[i].push_back(static_cast<std::int32_t>(i) - 1);
    if (i + 1 < at.size()) neighbours[i].push_back(static_cast<std::int32_t>(i) + 1);
  }
  return buildMergingTree(centroids, std::vector<double>(at.size(), 1.0), neighbours);
}

TEST(MergingTree, IsThatOfTheThesisForItsNineFaces) {
  const MergingTree tree = figureTree();
  ASSERT_EQ(tree.nodes.size(), 16);
  EXPECT_EQ(tree.nodes[9].children, (List{0, 1}));      // node 10
  EXPECT_EQ(tree.nodes[10].children, (List{2, 3, 4}));  // node 11 has three children
  EXPECT_EQ(tree.nodes[11].children, (List{5, 6}));     // node 12
  EXPECT_EQ(tree.nodes[12].children, (List{7, 8}));     // node 13
  EXPECT_EQ(tree.nodes[13].children, (List{9, 10}));    // node 14
  EXPECT_EQ(tree.nodes[14].children, (List{11, 12}));   // node 15
  EXPECT_EQ(tree.nodes[15].children, (List{13, 14}));   // node 16, the root
  EXPECT_EQ(tree.nodes[15].parent, -1);
  EXPECT_DOUBLE_EQ(tree.nodes[15].area, 9);
  EXPECT_NEAR(tree.nodes[10].centroid.x(), (4 + 5.2 + 6.8) / 3, 1e-12);
}

TEST(MergingTree, HoldsEveryFaceOnceAndItsArea) {
  const MergingTree tree = figureTree();
  std::vector<int> seen(9, 0);
  for (const auto& node : tree.nodes) {
    for (const std::int32_t child : node.children) {
      if (child < 9) ++seen[child];
    }
  }
  EXPECT_EQ(seen, std::vector<int>(9, 1));
}

TEST(MergingTree, JoinsPartsThatAreNoNeighbours) {
  const MergingTree tree =
      buildMergingTree({Point(0, 0, 0), Point(1, 0, 0), Point(9, 0, 0)}, {1, 2, 3}, {{1}, {0}, {}});
  ASSERT_EQ(tree.nodes.size(), 5);
  EXPECT_DOUBLE_EQ(tree.nodes[4].area, 6);
}

TEST(ThesisTree, AgreesWithAllPairsToItsOwnAccuracy) {
  const TriangleMesh folded = geometry::makeFoldedSphere(2);
  const KnotValue exact = AllPairs(folded, everyVertex(folded)).evaluate(folded.positions);
  const KnotValue tree = ThesisTree(folded, everyVertex(folded)).evaluate(folded.positions);
  EXPECT_NEAR(tree.value, exact.value, 0.01 * exact.value);
  EXPECT_LT((tree.gradient - exact.gradient).norm(), 0.05 * exact.gradient.norm());
  ThesisTreeOptions careful;
  careful.nearDistance = 8;
  careful.relativeError = 1e-4;
  const KnotValue better =
      ThesisTree(folded, everyVertex(folded), careful).evaluate(folded.positions);
  EXPECT_LT((better.gradient - exact.gradient).norm(),
            0.5 * (tree.gradient - exact.gradient).norm());
}

TEST(ThesisTree, DividesByTheCentroidDistanceNotByThatOfSums) {
  // Two faces 50 apart.  With [Thesis, Eq. 5.45] as printed, the gradient within a face, which is
  // the term of its area, would be a ninth of the exact one.
  TriangleMesh far;
  far.positions = (Positions(6, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0,  //
                   0, 0, 50, 2, 0, 50, 0, 2, 50)
                      .finished();
  far.faces = (Faces(2, 3) << 0, 1, 2, 3, 4, 5).finished();
  const KnotValue exact = AllPairs(far, everyVertex(far)).evaluate(far.positions);
  const KnotValue tree = ThesisTree(far, everyVertex(far)).evaluate(far.positions);
  EXPECT_GT(exact.gradient(1, 0), 0);
  EXPECT_NEAR(tree.gradient(1, 0), exact.gradient(1, 0), 0.01 * exact.gradient(1, 0));
}

TEST(ThesisTree, CountsFixedFacesTwice) {
  const TriangleMesh folded = geometry::makeFoldedSphere(2);
  std::vector<bool> some(static_cast<std::size_t>(folded.vertexCount()), false);
  for (std::size_t v = 0; v < some.size(); ++v) {
    some[v] = folded.positions(static_cast<Eigen::Index>(v), 2) > 0.4;
  }
  const KnotValue exact = AllPairs(folded, some).evaluate(folded.positions);
  const KnotValue tree = ThesisTree(folded, some).evaluate(folded.positions);
  EXPECT_NEAR(tree.value, exact.value, 0.01 * exact.value);
}

TEST(ThesisTree, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh folded = geometry::makeFoldedSphere(2);
  const ThesisTree tree(folded, everyVertex(folded));
  setThreadCount(1);
  const KnotValue one = tree.evaluate(folded.positions);
  setThreadCount(4);
  const KnotValue four = tree.evaluate(folded.positions);
  setThreadCount(0);
  EXPECT_EQ(one.value, four.value);
  EXPECT_EQ(one.gradient, four.gradient);
}

TEST(ThesisTree, RefusesOptionsOutOfRange) {
  const TriangleMesh sphere = geometry::makeIcosphere(0);
  EXPECT_THROW(ThesisTree(sphere, everyVertex(sphere), {-1, 0.02}), InvalidInput);
  EXPECT_THROW(ThesisTree(sphere, everyVertex(sphere), {1, 0}), InvalidInput);
}

}  // namespace
}  // namespace explica::repulsion
