// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Hemisphere.h"

#include "Explica/Segmentation/VoxelBox.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace explica::segmentation {
namespace {

/// Two mirrored half balls of white with a grey shell, a deep structure and a ventricle in each,
/// joined at the midline, and a stem below.  Grid axes may be flipped.
struct HeadPhantom {
  TissueSegmentation tissue;
  Volume<Label> atlas;
  AtlasLegend legend;
};

constexpr std::string_view kLegend =
    "1 Frontal_L 2101\n2 Frontal_R 2102\n3 Thalamus_L\n4 Thalamus_R\n5 Cerebelum_L\n"
    "6 Hippocampus_L\n7 Hippocampus_R\n";

HeadPhantom makeHeadPhantom(bool flipX) {
  Grid grid;
  grid.size = {70, 60, 60};
  grid.origin = Point(-34.5, -30, -30);
  if (flipX) {
    grid.direction.col(0) *= -1;
    grid.origin.x() = 34.5;
  }
  HeadPhantom p;
  p.legend = parseAtlasLegend(kLegend, "legend");
  p.tissue.labels = Volume<Label>(grid, 0);
  for (auto& q : p.tissue.probability) q = Volume<float>(grid, 0.0f);
  p.atlas = Volume<Label>(grid, 0);
  for (std::size_t v = 0; v < p.atlas.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point w = grid.toWorld(Vector(i, j, k));
    const bool left = w.x() < 0;
    const Point m(std::abs(w.x()), w.y(), w.z());
    Label tissue = 0;
    const double r = w.norm();
    if (r < 26) tissue = kGrey;
    if (r < 22) tissue = kWhite;
    if (r >= 22 && r < 26) p.atlas[v] = left ? 1 : 2;
    if ((m - Point(6, 0, 0)).norm() < 4) {
      tissue = kGrey;
      p.atlas[v] = left ? 3 : 4;
    }
    if ((m - Point(6, 0, 6)).norm() < 3) {
      tissue = kCsf;
      p.atlas[v] = 0;
    }
    // Hippocampus below the thalamus, and between the two the stem.
    if ((m - Point(11, 0, -10)).norm() < 4) {
      tissue = kGrey;
      p.atlas[v] = left ? 6 : 7;
    }
    p.tissue.labels[v] = tissue;
    if (tissue != 0) p.tissue.probability[tissue - 1][v] = 1;
  }
  return p;
}

TEST(Hemisphere, TakesTheNamedSideWhicheverWayTheGridRuns) {
  for (const bool flip : {false, true}) {
    const HeadPhantom p = makeHeadPhantom(flip);
    const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
    for (std::size_t v = 0; v < left.labels.size(); ++v) {
      if (left.labels[v] != kWhite && left.labels[v] != kGrey) continue;
      const auto [i, j, k] = p.atlas.grid.subscripts(v);
      ASSERT_LT(p.atlas.grid.toWorld(Vector(i, j, k)).x(), 0);
    }
    EXPECT_GT(left.whiteVoxels, 15000);
  }
}

TEST(Hemisphere, FillsDeepStructuresAndVentricles) {
  const HeadPhantom p = makeHeadPhantom(false);
  const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
  const auto labelAt = [&](const Point& w) {
    const Vector at = p.atlas.grid.toIndex(w);
    return left.labels(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                       static_cast<int>(std::lround(at.z())));
  };
  EXPECT_EQ(labelAt(Point(-6, 0, 0)), kWhite);
  EXPECT_EQ(labelAt(Point(-6, 0, 6)), kWhite);
  EXPECT_EQ(labelAt(Point(-24, 0, 0)), kGrey);
  EXPECT_GT(left.deepVoxels, 100);
  EXPECT_GT(left.ventricleVoxels, 30);
}

TEST(Hemisphere, FillsWhatTheAtlasLeavesOfTheHippocampus) {
  HeadPhantom p = makeHeadPhantom(false);
  const Point hippocampus(-11, 0, -10);
  for (std::size_t v = 0; v < p.atlas.size(); ++v) {
    const auto [i, j, k] = p.atlas.grid.subscripts(v);
    if ((p.atlas.grid.toWorld(Vector(i, j, k)) - hippocampus).norm() >= 8) continue;
    if (p.tissue.labels[v] != kWhite) continue;
    p.tissue.labels[v] = kGrey;  // larger than the atlas knows, and in touch with cortex
    std::swap(p.tissue.probability[1][v], p.tissue.probability[2][v]);
  }
  const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
  const Vector outward = hippocampus.normalized();
  const auto labelAt = [&](const Point& w) {
    const Vector at = p.atlas.grid.toIndex(w);
    return left.labels(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                       static_cast<int>(std::lround(at.z())));
  };
  EXPECT_EQ(labelAt(hippocampus + 5 * outward), kWhite);
  EXPECT_EQ(labelAt(hippocampus + Vector(0, 7, 0)), kWhite);
  EXPECT_EQ(labelAt(23 * outward), kGrey) << "cortex";
}

// A horn of the ventricle and a pocket of a sulcus, both beside cortex and in the midst of what the
// atlas calls cortex.
TEST(Hemisphere, FillsClosedFluidBesideWhatIsFilled) {
  HeadPhantom p = makeHeadPhantom(false);
  const Point horn(-13, 4.5, -13), pocket(-14, 0, 13);
  for (std::size_t v = 0; v < p.atlas.size(); ++v) {
    const auto [i, j, k] = p.atlas.grid.subscripts(v);
    const Point w = p.atlas.grid.toWorld(Vector(i, j, k));
    if (p.tissue.labels[v] != kWhite || std::min((w - horn).norm(), (w - pocket).norm()) > 3) {
      continue;
    }
    p.atlas[v] = 1;
    p.tissue.labels[v] = kCsf;
    std::swap(p.tissue.probability[0][v], p.tissue.probability[2][v]);
  }
  const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
  const auto labelAt = [&](const Point& w) {
    const Vector at = p.atlas.grid.toIndex(w);
    return left.labels(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                       static_cast<int>(std::lround(at.z())));
  };
  EXPECT_EQ(labelAt(horn), kWhite);
  EXPECT_EQ(labelAt(pocket), kCsf);
}

/// A T1 of the phantom.
Volume<float> brightnessOf(const HeadPhantom& p) {
  constexpr std::array<float, 4> kBrightness = {0, 30, 80, 110};
  Volume<float> brain(p.atlas.grid);
  for (std::size_t v = 0; v < brain.size(); ++v) brain[v] = kBrightness[p.tissue.labels[v]];
  return brain;
}

/// Fluid leads from the ventricles to where the mask of the brain ends.
void openVentricles(HeadPhantom& p) {
  for (std::size_t v = 0; v < p.atlas.size(); ++v) {
    const auto [i, j, k] = p.atlas.grid.subscripts(v);
    const Point w = p.atlas.grid.toWorld(Vector(i, j, k));
    const double off = std::hypot(std::abs(w.x()) - 6, w.z() - 6);
    if (off > 1.2 || w.y() < 0) continue;
    p.tissue.labels[v] = w.y() > 12 ? Label{0} : Label{kCsf};
    for (auto& q : p.tissue.probability) q[v] = 0;
    if (w.y() <= 12) p.tissue.probability[0][v] = 1;
  }
}

TEST(Hemisphere, FillsAnOpenVentricleThatATemplateKnows) {
  const HeadPhantom known = makeHeadPhantom(false);
  Volume<Label> atlas = known.atlas;
  AtlasLegend legend = known.legend;
  labelVentricles(brightnessOf(known), atlas, legend);
  HeadPhantom head = makeHeadPhantom(false);
  openVentricles(head);
  const auto labelAt = [](const Volume<Label>& labels, const Point& w) {
    const Vector at = labels.grid.toIndex(w);
    return labels(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                  static_cast<int>(std::lround(at.z())));
  };
  EXPECT_EQ(legend.at(labelAt(atlas, Point(-6.5, 0, 6))).name, "Deep_ventricle_L");
  EXPECT_EQ(legend.at(labelAt(atlas, Point(6.5, 0, 6))).name, "Deep_ventricle_R");
  EXPECT_EQ(labelAt(atlas, Point(-6.5, 10, 6)), 0);
  const Hemisphere without = extractHemisphere(head.tissue, known.atlas, known.legend);
  EXPECT_EQ(labelAt(without.labels, Point(-6.5, 0, 6)), kCsf);
  const Hemisphere left = extractHemisphere(head.tissue, atlas, legend);
  EXPECT_EQ(labelAt(left.labels, Point(-6.5, 0, 6)), kWhite);
  EXPECT_EQ(labelAt(left.labels, Point(-6.5, 5, 6)), kWhite) << "larger than the template's";
  EXPECT_EQ(labelAt(left.labels, Point(-6.5, 11, 6)), kCsf) << "nearer to the outside";
}

TEST(Hemisphere, LeavesTheStemOutAndMarksTheCut) {
  const HeadPhantom p = makeHeadPhantom(false);
  const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
  const Vector stem = p.atlas.grid.toIndex(Point(-2.5, 0, -10));
  const Vector across = p.atlas.grid.toIndex(Point(3.5, 10, 0));
  EXPECT_EQ(left.labels(static_cast<int>(std::lround(stem.x())), static_cast<int>(stem.y()),
                        static_cast<int>(stem.z())),
            kCut);
  EXPECT_EQ(left.labels(static_cast<int>(std::lround(across.x())), static_cast<int>(across.y()),
                        static_cast<int>(across.z())),
            kCut);
}

TEST(Hemisphere, TheUnlabelledRimOfOtherCortexIsNoStem) {
  HeadPhantom p = makeHeadPhantom(false);
  const auto linear = [&](const Point& w) {
    const Vector at = p.atlas.grid.toIndex(w);
    return p.atlas.grid.linear(static_cast<int>(std::lround(at.x())),
                               static_cast<int>(std::lround(at.y())),
                               static_cast<int>(std::lround(at.z())));
  };
  for (std::size_t v = 0; v < p.atlas.size(); ++v) {
    const auto [i, j, k] = p.atlas.grid.subscripts(v);
    if (p.atlas.grid.toWorld(Vector(i, j, k)).norm() >= 25) p.atlas[v] = 0;
  }
  const Point rim(-2.5, 0, -25);  // below the thalamus, between the hippocampi
  ASSERT_EQ(p.atlas[linear(rim)], 0);
  const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
  EXPECT_EQ(left.labels[linear(rim)], kGrey);
  EXPECT_EQ(left.labels[linear(Point(-2.5, 0, -10))], kCut);
}

/// A ball as bright as white matter, joined to it by a single row of voxels, and what is about it.
void hangBall(HeadPhantom& p, Label about) {
  const Point middle(-12.5, 16, 10);
  for (std::size_t v = 0; v < p.atlas.size(); ++v) {
    const auto [i, j, k] = p.atlas.grid.subscripts(v);
    const Point w = p.atlas.grid.toWorld(Vector(i, j, k));
    const double r = (w - middle).norm();
    if (r > 8) continue;
    const bool thread = std::abs(w.x() - middle.x()) < 0.5 && std::abs(w.z() - middle.z()) < 0.5 &&
                        w.y() < middle.y();
    const Label tissue = r < 5.5 || thread ? Label{kWhite} : about;
    p.tissue.labels[v] = tissue;
    for (auto& q : p.tissue.probability) q[v] = 0;
    if (tissue != 0) p.tissue.probability[tissue - 1][v] = 1;
  }
}

TEST(Hemisphere, LeavesOutWhatHangsByAThreadWithoutCortexAboutIt) {
  const auto whiteWith = [](Label about) {
    HeadPhantom p = makeHeadPhantom(false);
    hangBall(p, about);
    return extractHemisphere(p.tissue, p.atlas, p.legend).whiteVoxels;
  };
  // Within cortex it is white matter's, however thin the bridge.
  const auto kept = static_cast<double>(whiteWith(kGrey));
  const double ball = 4.0 / 3 * kPi * std::pow(5.5, 3);
  EXPECT_NEAR(kept - static_cast<double>(whiteWith(0)), ball, 0.1 * ball);  // with the thread
}

// Muscle below the temporal lobe: as bright as cortex, joined to it, and reached by no white
// matter.
TEST(Hemisphere, LeavesOutGreyThatIsFarFromWhiteMatter) {
  for (const double slice : {1.0, 2.0}) {
    HeadPhantom p = makeHeadPhantom(false);
    p.tissue.labels.grid.spacing.z() = p.atlas.grid.spacing.z() = slice;
    for (auto& q : p.tissue.probability) q.grid = p.atlas.grid;
    const auto before = extractHemisphere(p.tissue, p.atlas, p.legend);
    const Volume<Label> cortex = p.tissue.labels;
    // A plate beside the hemisphere from 2 to 30 mm off its white matter.
    for (std::size_t v = 0; v < p.atlas.size(); ++v) {
      const auto [i, j, k] = p.atlas.grid.subscripts(v);
      if (i > 30 || j < 25 || j > 34 || k < 28 || k > 32 || p.tissue.labels[v] != 0) continue;
      p.tissue.labels[v] = kGrey;
      p.tissue.probability[1][v] = 1;
    }
    const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend);
    std::int64_t kept = 0;
    for (std::size_t v = 0; v < cortex.size(); ++v) {
      if (cortex[v] != 0) {
        ASSERT_EQ(left.labels[v], before.labels[v]);
        continue;
      }
      if (left.labels[v] != kGrey) continue;
      ++kept;
      const auto [i, j, k] = p.atlas.grid.subscripts(v);
      const Vector w = Vector(i - 34.5, j - 30, k - 30);
      EXPECT_LT(w.norm(), 22 + 6 + 1) << slice;
    }
    EXPECT_GT(kept, 0);
    EXPECT_GT(left.strayVoxels, 100) << slice;
  }
}

TEST(Hemisphere, LeftAndRightShareNoVoxel) {
  const HeadPhantom p = makeHeadPhantom(false);
  HemisphereOptions options;
  const Hemisphere left = extractHemisphere(p.tissue, p.atlas, p.legend, options);
  options.side = Side::Right;
  const Hemisphere right = extractHemisphere(p.tissue, p.atlas, p.legend, options);
  for (std::size_t v = 0; v < left.labels.size(); ++v) {
    const bool inLeft = left.labels[v] == kWhite || left.labels[v] == kGrey;
    const bool inRight = right.labels[v] == kWhite || right.labels[v] == kGrey;
    ASSERT_FALSE(inLeft && inRight);
  }
  EXPECT_EQ(left.greyVoxels, right.greyVoxels);
}

TEST(Hemisphere, SaysWhatIsWrongWithTheAtlas) {
  HeadPhantom p = makeHeadPhantom(false);
  p.atlas[5] = 99;
  EXPECT_THROW((void)extractHemisphere(p.tissue, p.atlas, p.legend), InvalidInput);
  EXPECT_THROW((void)parseAtlasLegend("1 Frontal_L\n", "legend"), InvalidInput);
  EXPECT_THROW((void)parseAtlasLegend("1 A_L\n1 B_R\n", "legend"), InvalidInput);
  EXPECT_THROW((void)parseAtlasLegend("word\n", "legend"), InvalidInput);
}

TEST(AtlasLegend, ReadsSidesAndKindsFromNames) {
  const AtlasLegend legend = parseAtlasLegend(kLegend, "legend");
  EXPECT_EQ(legend.at(1).side, Side::Left);
  EXPECT_EQ(legend.at(4).kind, StructureKind::Deep);
  EXPECT_EQ(legend.at(5).kind, StructureKind::BelowTent);
}

TEST(ResampledLabels, KeepValuesOnAShiftedGrid) {
  Grid a;
  a.size = {4, 4, 4};
  Volume<Label> labels(a, 0);
  labels(2, 1, 3) = 7;
  Grid b = a;
  b.origin = Point(1, 0, 0);
  const Volume<Label> moved = resampleLabels(labels, b);
  EXPECT_EQ(moved(1, 1, 3), 7);
  EXPECT_EQ(moved(3, 0, 0), 0);
}

TEST(VoxelBox, HoldsWhatIsThereAndPutsItBack) {
  Grid grid;
  grid.size = {9, 8, 7};
  grid.spacing = Vector(1, 2, 3);
  Volume<float> volume(grid, 0.0f);
  volume(3, 4, 5) = 7;
  volume(5, 4, 2) = 8;
  const VoxelBox box = VoxelBox::around(volume, 1);
  EXPECT_EQ(box.grid().size, (std::array{5, 3, 6}));
  const Volume<float> part = box.of(volume);
  EXPECT_EQ(part(1, 1, 4), 7);
  EXPECT_LT((part.grid.toWorld(Vector(1, 1, 4)) - grid.toWorld(Vector(3, 4, 5))).norm(), 1e-12);
  EXPECT_EQ(box.putBack(part).data, volume.data);
  EXPECT_EQ(box.putBack(part, 1.0f)(0, 0, 0), 1);
  EXPECT_EQ(VoxelBox::around(Volume<float>(grid, 0.0f), 2).grid().size, grid.size);
  EXPECT_THROW((void)box.of(part), InvalidInput);
}

TEST(AtlasLegend, OfInia19PutsAThousandBetweenTheSides) {
  const AtlasLegend legend = inia19Legend();
  int cortical = 0;
  for (const auto& [label, structure] : legend) {
    const bool right = label > 1000;
    EXPECT_EQ(structure.side, right ? Side::Right : Side::Left) << label;
    if (!right) {
      EXPECT_EQ(legend.at(label + 1000).kind, structure.kind) << label;
      cortical += structure.kind == StructureKind::Cortex;
    }
  }
  EXPECT_EQ(cortical, 32);
  EXPECT_EQ(legend.at(1147).name, "Precentral_R");
  EXPECT_EQ(legend.at(82).kind, StructureKind::Deep);        // caudate nucleus
  EXPECT_EQ(legend.at(55).kind, StructureKind::White);       // cerebral white matter
  EXPECT_EQ(legend.at(230).kind, StructureKind::BelowTent);  // of the cerebellum
}

}  // namespace
}  // namespace explica::segmentation
