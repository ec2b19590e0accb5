// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Atlas.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace explica::segmentation {
namespace {

constexpr Label kLast = 606;    // of the left side
constexpr Label kRight = 1000;  // added to the numbers on the left

/// Gyri and cortical areas.
constexpr std::array kCortex = {
    std::pair{1, "Occipital"},
    std::pair{3, "Lingual"},
    std::pair{4, "Cuneus"},
    std::pair{5, "Occipital_Inf"},
    std::pair{6, "Annectant"},
    std::pair{7, "Fusiform"},
    std::pair{8, "Angular"},
    std::pair{9, "Precuneus"},
    std::pair{10, "Parietal_Sup"},
    std::pair{37, "Temporal_Inf"},
    std::pair{45, "SupraMarginal"},
    std::pair{54, "Temporal_Sup"},
    std::pair{58, "Temporal_Mid"},
    std::pair{63, "Fasciolar"},
    std::pair{65, "Cingulum_Post"},
    std::pair{69, "ParaHippocampal"},
    std::pair{70, "Cingulum_Isthmus"},
    std::pair{111, "Postcentral"},
    std::pair{147, "Precentral"},
    std::pair{153, "Insula"},
    std::pair{166, "Entorhinal"},
    std::pair{180, "Cingulum_Ant"},
    std::pair{196, "Frontal_Sup"},
    std::pair{211, "Periamygdalar"},
    std::pair{212, "Prepyriform"},
    std::pair{213, "Frontal_Mid"},
    std::pair{214, "Frontal_Inf"},
    std::pair{215, "Fronto_Orbital"},
    std::pair{216, "Orbital_Lat"},
    std::pair{217, "Rectus"},
    std::pair{219, "Olfactory"},
    std::pair{220, "Orbital_Med"},
};

/// White matter of the hemispheres, the callosum, the capsules beside the claustrum and it.
constexpr std::array kWhiteAreas = {2, 55, 71, 124, 148, 149, 150, 151, 193, 221, 473};

/// Basal ganglia, thalamus, hypothalamus, hippocampus, amygdala, fornix, ventricles.
constexpr std::array kDeep = {
    51,  73,  74,  82,  86,  87,  89,  90,  91,  92,  94,  95,  96,  97,  98,  99,  100, 101,
    114, 115, 116, 117, 122, 123, 125, 127, 128, 129, 130, 131, 134, 135, 136, 137, 152, 158,
    159, 160, 161, 162, 163, 164, 165, 168, 169, 170, 171, 172, 174, 175, 176, 177, 178, 179,
    181, 183, 184, 185, 186, 187, 188, 189, 190, 191, 192, 194, 195, 197, 198, 199, 200, 201,
    202, 203, 204, 205, 206, 207, 208, 209, 210, 222, 273, 283, 284, 285, 287, 288, 289, 290,
    291, 292, 297, 319, 321, 322, 323, 324, 325, 326, 327, 328, 363, 364, 365, 423, 433, 446,
    447, 448, 449, 450, 451, 452, 453, 454, 456, 457, 458, 459, 461, 462, 463, 464, 467, 469,
    470, 471, 475, 476, 477, 478, 479, 480, 481, 482, 483, 484, 488, 489, 490, 491, 492, 493,
    495, 496, 497, 498, 499, 500, 501, 507, 510, 521};

}  // namespace

AtlasLegend inia19Legend() {
  AtlasLegend legend;
  const auto add = [&](Label label, const std::string& name) {
    legend[label] = structureNamed(name + "_L");
    legend[label + kRight] = structureNamed(name + "_R");
  };
  for (Label label = 1; label <= kLast; ++label) {
    const auto in = [&](const auto& labels) {
      return std::binary_search(labels.begin(), labels.end(), static_cast<int>(label));
    };
    const char* kind = in(kWhiteAreas) ? "White_" : in(kDeep) ? "Deep_" : "Below_";
    add(label, kind + std::to_string(label));
  }
  for (const auto& [label, name] : kCortex) add(label, name);
  return legend;
}

}  // namespace explica::segmentation
