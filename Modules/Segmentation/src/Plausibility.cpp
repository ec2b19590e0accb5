// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Plausibility.h"

#include "Explica/Core/Runs.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/VoxelSets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace explica::segmentation {
namespace {

// What an image must be within to be believed, and where the limit comes from.
constexpr Limit kLimits[] = {
    {"hounsfield", "the share of voxels below -500", "", 0, 0.05,
     "this looks like a CT; give a T1-weighted image",
     "air is -1000 in a CT and 0 or noise in a magnitude image"},
    {"labels", "the share of neighbouring voxels of equal value", "", 0, 0.5,
     "this looks like a label image; give the T1 itself",
     "measured: T1s 0.00 to 0.24, anatomical label maps 0.85 to 0.95"},
    {"thick-slices", "the longest edge of a voxel", "mm", 0, 5,
     "the image looks like a stack of thick slices, as of a heart; give a T1 of a head in voxels "
     "of about 1 mm",
     "cortex is 2.5 mm thick; stacks of hearts have 6 to 10 mm"},
    {"bright-fluid", "the skewness of brightness deep in the head", "", -1, 0.2,
     "the fluid is no darker than the rest, so the image looks like a T2 or a proton density "
     "image; give the T1 of the same person",
     "measured: three brains and eleven simulated heads with fields to 40 % -0.65 to 0.01; proton "
     "density images simulated from two label maps 0.13 to 0.34, of which some pass, T2s 0.62 to "
     "0.68"},
    {"bright-vessels", "the brightest thousandth deep in the head over the median", "", 0, 2.3,
     "a few voxels are far brighter than the rest, so the image looks like an angiogram, or like "
     "one with contrast agent in vessels; give a T1 without",
     "measured: nine T1s 1.1 to 2.0; angiograms simulated from three label maps 2.6 to 2.9"},
    {"contrast", "the ratio of dark to bright tissue at the brain's surface", "", 1, kInfinity,
     "this does not look like a T1-weighted brain, whose white matter is bright and deep and whose "
     "fluid is dark and outside",
     "a T1 without fluid at its rim, stripped along the folds, has 3, bert 26; below 1 bright "
     "tissue lies outside"},
    {"registration", "the agreement with the template", "", 0.6, 1,
     "the template did not reach the head; look at the outlines in the report, or give --atlas and "
     "--mask",
     "measured: six good registrations 0.78 to 1.00; a head upside down or cut 0.35 to 0.52 "
     "(Modules/Registration/README.md)"},
    {"fluid-of-white", "the brightness of the template's fluid over that of its white matter", "",
     0, 0.8,
     "the fluid is not dark, so the image looks like a T2 or a proton density image; give the T1 "
     "of the same person",
     "measured: eight brains, five heads and bert 0.12 to 0.27, half a head with the template in "
     "the wrong place 0.63; a proton density image simulated from a label map 0.90"},
    {"stretch", "the template's longest over its shortest stretch onto the head", "", 1, 1.5,
     "a part of the head may be missing, over which the template was squeezed; look at the "
     "outlines in the report, or give --atlas",
     "breadth over length of heads is 0.7 to 0.9; measured: heads 1.00 to 1.20, half a brain 1.92 "
     "(Modules/Registration/README.md)"},
    {"brain-border", "the share of the brain's border beyond which tissue goes on", "", 0, 0.1,
     "the skull was not found; look at brain_mask.nii.gz, or give --mask",
     "measured: 0.000 to 0.025 in twelve simulated heads whose brain is whole, above 0.5 in a ball "
     "of tissue without a skull; what a cut does to the cortex of a place is told as its doubt"},
    {"brain-volume", "the brain's volume", "ml", 300, 2500,
     "skull or neck may be left in the brain, or parts of it missing; another species needs "
     "--template",
     "adult brains with their fluid are 1000 to 2000 ml, newborn ones about 400 (Gilmore et al. "
     "2007, J. Neurosci. 27:1255)"},
    {"grey-share", "grey matter's share of the brain", "", 0.20, 0.65,
     "the tissues may be confused; look at seg.nii.gz",
     "38 to 55 % over adult life (Courchesne et al. 2000, Radiology 216:672), and a margin"},
    {"white-share", "white matter's share of the brain", "", 0.20, 0.65,
     "the tissues may be confused; look at seg.nii.gz",
     "26 to 38 % over adult life (Courchesne et al. 2000, Radiology 216:672), and a margin"},
    {"noise", "the noise over the contrast of fluid and white matter", "", 0, 0.12,
     "the image is too noisy to tell the tissue of a voxel; give a mean of several images",
     "measured: 0.02 to 0.03 in bert, two brains and Colin27; simulated heads with a noise of 3, "
     "6, "
     "7, 8 and 9 % of white matter 0.06, 0.11, 0.117, 0.13 and 0.14, grey matter's Dice 0.96, "
     "0.90, "
     "0.86, 0.82 and 0.78"},
    {"bright-in-brain", "the share of the brain that is a fifth brighter than white matter", "", 0,
     0.01,
     "vessels with contrast agent may be called white matter; look at seg.nii.gz, or give a T1 "
     "without",
     "measured: 0.0000 to 0.0004 in eight T1s and a simulated head, 0.004 in bert, whose arteries "
     "are bright; 0.017 with vessels simulated 1.3 times as bright as white matter"},
    {"half-head", "the volume of the left half over that of the right one", "", 0.75, 1.33,
     "a part of the head may lie outside of the image",
     "hemispheres differ by a few per cent in the healthy (Giedd et al. 1996, Cereb. Cortex "
     "6:551); beyond a quarter, tissue is missing"},
    {"thickness-mean", "the mean thickness of the cortex", "mm", 1, 5,
     "one of its borders may be in the wrong place",
     "1 to 4.5 mm from place to place (Fischl, Dale 2000, Proc. Natl. Acad. Sci. USA 97:11050)"},
    {"without-thickness", "the share of grey voxels without thickness", "", 0, 0.02,
     "the tissue does not lie between its two borders there",
     "measured: 0 to 0.3 % in whole hemispheres"},
    {"corrected", "the share of the white surface that was made by correcting its topology", "", 0,
     0.05, "white matter may be noise; look at topology.tsv and the surface there",
     "measured: below 0.01 in T1s of 1 mm of 17 people, nine of them simulated, and in the label "
     "maps of six of these, 0.02 with a noise of 9 % of white matter, 0.03 in a T1 of 2 mm"},
    {"exchanged", "the share of white matter's border without grey matter upon it", "", 0, 0.3,
     "white matter may be exchanged with grey matter or fluid",
     "measured: 0.01 to 0.14 in six people's T1s and seven people's label maps, 0.51 to 0.56 where "
     "labels are exchanged"},
};

std::string shortNumber(double value) {
  const bool large = std::abs(value) >= 1000 && std::isfinite(value);
  return printed(large ? "%.0f" : "%.3g", value);
}

std::string rangeOf(const Limit& limit) {
  const std::string unit = limit.unit.empty() ? "" : " " + std::string(limit.unit);
  if (!std::isfinite(limit.high)) return "at least " + shortNumber(limit.low) + unit;
  if (limit.low == 0) return "at most " + shortNumber(limit.high) + unit;
  return shortNumber(limit.low) + " to " + shortNumber(limit.high) + unit;
}

std::string sentenceOf(const Limit& limit, double value) {
  const std::string unit = limit.unit.empty() ? "" : " " + std::string(limit.unit);
  const std::string found =
      std::isnan(value) ? " cannot be computed" : " is " + shortNumber(value) + unit;
  return std::string(limit.remedy) + " (" + std::string(limit.what) + found + ", expected " +
         rangeOf(limit) + ")";
}

template <class T>
double shareOfEqualNeighbours(const Volume<T>& volume) {
  std::int64_t pairs = 0;
  std::int64_t equal = 0;
  forContacts(volume, [&](T a, T b) {
    if (a == T{0} || b == T{0}) return;
    ++pairs;
    if (a == b) ++equal;
  });
  return pairs == 0 ? 0 : static_cast<double>(equal) / static_cast<double>(pairs);
}

constexpr std::size_t kFewestGreyValues = 64;  // a parcellation may have more, a T1 has
constexpr double kMostEqualInImage = 0.3;      // above the T1s', below the parcellations' 0.8
constexpr double kRim = 0.05;                  // of the brain's radius: 3 to 4 mm in an adult

}  // namespace

std::span<const Limit> limits() {
  return kLimits;
}

const Limit& limitNamed(std::string_view name) {
  std::string names;
  for (const Limit& limit : kLimits) {
    if (limit.name == name) return limit;
    names += (names.empty() ? "" : ", ") + std::string(limit.name);
  }
  throw InvalidInput("accept: '" + std::string(name) + "' is not one of " + names);
}

void checkAccepted(const std::vector<std::string>& accepted) {
  for (const std::string& name : accepted) (void)limitNamed(name);
}

std::optional<Flag> judge(std::string_view name, double value,
                          const std::vector<std::string>& accepted) {
  const Limit& limit = limitNamed(name);
  if (value >= limit.low && value <= limit.high) return {};
  const bool known = std::find(accepted.begin(), accepted.end(), name) != accepted.end();
  return Flag{std::string(name), value, limit.low, limit.high, known, sentenceOf(limit, value)};
}

double equalNeighbours(const Volume<float>& image) {
  return shareOfEqualNeighbours(image);
}

double equalNeighbours(const Volume<Label>& labels) {
  return shareOfEqualNeighbours(labels);
}

bool looksLikeImage(const Volume<Label>& labels) {
  std::set<Label> found;
  for (std::size_t v = 0; v < labels.size(); v = runEnd(labels.data.data(), v, labels.size())) {
    found.insert(labels[v]);
    if (found.size() > kFewestGreyValues) return equalNeighbours(labels) < kMostEqualInImage;
  }
  return false;
}

bool looksLikeLabels(const Volume<float>& image) {
  const bool whole = std::all_of(image.data.begin(), image.data.end(),
                                 [](float value) { return value == std::floor(value); });
  return whole && equalNeighbours(image) > limitNamed("labels").high;
}

double airInHounsfieldUnits(const Volume<float>& image) {
  const auto air =
      std::count_if(image.data.begin(), image.data.end(), [](float value) { return value < -500; });
  return static_cast<double>(air) / static_cast<double>(image.size());
}

double greyAtMaskEdge(const Volume<Label>& tissues) {
  const Grid& grid = tissues.grid;
  double outside = 0, fluid = 0;  // mm^2 of voxel faces
  for (std::size_t v = 0; v < tissues.size(); ++v) {
    if (tissues[v] != kGrey) continue;
    const auto neighbours = grid.neighbours(v);
    for (int d = 0; d < 6; ++d) {
      const Label other = neighbours[d] < 0 ? Label{0} : tissues[neighbours[d]];
      const double area = grid.voxelVolume() / grid.spacing[d / 2];
      if (other == 0) outside += area;
      if (other == kCsf) fluid += area;
    }
  }
  return outside + fluid > 0 ? outside / (outside + fluid) : kNaN;
}

double noiseOfContrast(const TissueSegmentation& tissue) {
  return tissue.noise / (tissue.classes[2].mean - tissue.classes[0].mean);
}

double brighterThanWhite(const Volume<float>& intensity, const TissueSegmentation& tissue) {
  const double least = kBrighterThanTissue * tissue.classes[2].mean;
  std::int64_t bright = 0;
  for (std::size_t v = 0; v < intensity.size(); ++v) {
    bright += tissue.labels[v] != 0 && intensity[v] > least * tissue.bias[v] ? 1 : 0;
  }
  return static_cast<double>(bright) / static_cast<double>(tissue.brainVoxels);
}

double rimContrast(const Volume<Label>& tissues) {
  std::array<double, 4> all{};
  for (std::size_t v = 0; v < tissues.size(); ++v) {
    if (tissues[v] >= kCsf && tissues[v] <= kWhite) ++all[tissues[v]];
  }
  const double brain = all[kCsf] + all[kGrey] + all[kWhite];
  const double radius = std::cbrt(0.75 / kPi * brain * tissues.grid.voxelVolume());
  const Volume<float> squared =
      squaredDistanceTo(setWhere(tissues.grid, [&](std::size_t v) { return tissues[v] == 0; }));
  const double most = std::max(kRim * radius, 1.01 * tissues.grid.spacing.minCoeff());
  std::array<double, 4> rim{};
  for (std::size_t v = 0; v < tissues.size(); ++v) {
    if (tissues[v] < kCsf || tissues[v] > kWhite || squared[v] > most * most) continue;
    ++rim[tissues[v]];
  }
  const double dark = all[kCsf] + all[kGrey];
  if (dark == 0 || all[kWhite] == 0) return kNaN;
  const double half = 0.5;  // of a voxel, for a class that the rim does not have at all
  return ((rim[kCsf] + rim[kGrey] + half) / dark) / ((rim[kWhite] + half) / all[kWhite]);
}

}  // namespace explica::segmentation
