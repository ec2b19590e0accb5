// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/EvolutionFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Testing/Curves.h"

#include <gtest/gtest.h>

namespace explica::planar {
namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

EvolutionStage stageOf(const Curve& curve) {
  return {"start", curve.positions, {0, 2}, 0.5, 0.1, 3, intersectingEdges(curve)};
}

TEST(EvolutionFigure, HasAPanelAStageAndNoRingWithoutCrossings) {
  const Curve square = makeCircle(4, 10);
  const std::string svg = drawEvolution(true, Point2(0, 100), {stageOf(square), stageOf(square)});
  EXPECT_EQ(countOf(svg, "visibility 0.500"), 2U);
  EXPECT_EQ(countOf(svg, "(b) start"), 1U);
  EXPECT_EQ(countOf(svg, "edges cross"), 0U);
  EXPECT_EQ(countOf(svg, "direction of view"), 1U);
  EXPECT_EQ(countOf(svg, "units of length"), 1U);
  EXPECT_THROW((void)drawEvolution(true, Point2(0, 100), {}), InvalidInput);
}

TEST(EvolutionFigure, RingsEveryCrossing) {
  Curve bow;
  bow.positions.resize(4, 2);
  bow.positions << 0, 0, 2, 2, 2, 0, 0, 2;
  const std::string svg = drawEvolution(true, Point2(0, 100), {stageOf(bow)});
  EXPECT_EQ(countOf(svg, "crossings 1"), 1U);
  EXPECT_EQ(countOf(svg, "stroke-width=\"1.80\""), 2U) << "one in the panel, one in the legend";
}

TEST(EvolutionFigure, OfManyVerticesDrawsWhatAPageTellsApart) {
  const Curve round = makeCircle(200000, 10);
  EvolutionStage whole = stageOf(round);
  whole.region = {0, round.edgeCount()};
  EXPECT_LT(drawEvolution(true, Point2(0, 100), {whole}).size(), 2000000U);
  const Curve square = makeCircle(4, 10);
  whole = stageOf(square);
  whole.region = {0, 4};
  EXPECT_EQ(countOf(drawEvolution(true, Point2(0, 100), {whole}), "stroke-width=\"3.20\""), 4U)
      << "the closing edge, too";
}

TEST(EvolutionFigure, ALineOfViewpointsHasTwoArrows) {
  const Curve square = makeCircle(4, 10);
  const Viewpoints line({Point2(-50, 100), Point2(0, 110), Point2(50, 100)}, {0.3, 0.4, 0.3});
  const auto arrows = [](const std::string& svg) { return countOf(svg, "<polygon"); };
  const std::size_t one = arrows(drawEvolution(true, Point2(0, 100), {stageOf(square)}));
  EXPECT_EQ(arrows(drawEvolution(true, line, {stageOf(square)})), one + 1);
}

TEST(EvolutionFigure, EvenStagesSpreadAValueEvenly) {
  const std::vector<double> values = {0, 0.1, 0.2, 0.5, 0.55, 0.6, 0.9, 1};
  EXPECT_EQ(evenStages(values, 3), (std::vector<std::size_t>{0, 3, 7}));
  EXPECT_EQ(evenStages(values, 20).size(), values.size());
  EXPECT_TRUE(evenStages({}, 3).empty());
}

}  // namespace
}  // namespace explica::planar
