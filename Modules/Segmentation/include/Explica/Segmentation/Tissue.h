// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Core/Volume.h"

#include <array>
#include <cstdint>

namespace explica::segmentation {

/// Labels of a tissue segmentation; 0 is outside the brain.
inline constexpr Label kCsf = 1;
inline constexpr Label kGrey = 2;
inline constexpr Label kWhite = 3;

/// Brightness that no tissue has, over that of white matter, a T1's brightest: fat, or a vessel.
inline constexpr double kBrighterThanTissue = 1.2;

/// How three tissue classes are found in a skull-stripped T1.
struct TissueOptions {
  double smooth = 0.8;    ///< weight of the Markov prior; 0 looks at each voxel alone
  double biasWidth = 25;  ///< standard deviation of the bias field's smoothing, mm; 0 for no field
  double localWidth = 8;  ///< of the windows in which edges tell a border's brightness, mm
  int maxIterations = 200;  ///< of expectation and maximisation
  double tolerance = 5e-4;  ///< stop once no class mean moves by more than this share of the range
};

template <class Visitor>
void describe(TissueOptions& options, Visitor&& visit) {
  visit(Field{"smooth", "", "weight of the Markov prior that smooths the classes; 0 for none"},
        options.smooth);
  visit(
      Field{"bias-width", "mm", "standard deviation of the bias field's smoothing; 0 for no field"},
      options.biasWidth);
  visit(Field{"local-width", "mm",
              "standard deviation of the windows in which edges tell the brightness of a border; 0 "
              "to take it from the tissues' means"},
        options.localWidth);
  visit(Field{"max-iterations", "", "expectation-maximisation iterations at most", 1, 1e6},
        options.maxIterations);
  visit(Field{"tolerance", "",
              "stop once no class mean moves by more than this share of their range"},
        options.tolerance);
}

/// Mean and spread of one class, in bias-corrected intensities.
struct TissueClass {
  double mean = kNaN;
  double deviation = kNaN;
  double share = kNaN;  ///< of the brain's voxels
};

/// Classes of a T1 and how they were found.
struct TissueSegmentation {
  Volume<Label> labels;  ///< 0 outside, kCsf, kGrey, kWhite: the likeliest class
  std::array<Volume<float>, 3> probability;  ///< of CSF, grey, white; sum 1 inside
  Volume<float> bias;                        ///< multiplicative field, geometric mean 1; 1 outside
  std::array<TissueClass, 3> classes;
  double deepFluid = kNaN;  ///< bias-corrected intensity of fluid far from other tissue, as in
                            ///< ventricles; the class's mean where there is none
  double noise = kNaN;      ///< its standard deviation, where brightness is even
  std::int64_t brainVoxels = 0;
  Termination termination = Termination::NotRun;
  int iterations = 0;
};

/// Cerebrospinal fluid, grey and white matter of a skull-stripped T1 image.
///
/// Expectation-maximisation of a mixture of y / b: three Gaussians for the pure tissues
/// and two blurred uniforms for voxels shared by fluid and grey or by grey and white [Santago1993].
/// A mean-field Markov prior looks at the six neighbours [VanLeemput1999, Zhang2001], weighed by
/// 1 / distance so that anisotropic voxels are treated alike.  It counts an eighth while the
/// classes are estimated, as smoothed voxels hide their class's spread.  In the end, with borders
/// put where the edges are, it counts in full, and mixtures no longer: they would explain any
/// voxel's noise.  The bias field b is smooth and multiplicative, the least-squares one under a
/// Gaussian window [Pham1999]: b = G * (sum_k p_k m_k y / s_k^2) / G * (sum_k p_k m_k^2 / s_k^2).
/// What is brighter than any tissue, as the orbit's fat is, and the layer in which it shares voxels
/// with what is dark, is taken out once classes are known, and given back as fluid.
/// `probability` of each tissue is 0.5 at a sub-voxel border.
/// Classes are ordered by their means, so the image must be T1-weighted.
///
/// @param intensity  I x J x K; the brain is where it is > 0;
///                   dark remains at its rim, as resampling and stripping leave them, are fluid
///                   from which nothing is learnt
/// @param mask       empty, or on the same grid: the brain is where it is != 0
/// @throws InvalidInput  a non-finite voxel, no voxel > 0, fewer than three distinct values, a mask
/// on
///                       another grid, or an option out of range
/// The result does not depend on the number of threads.  O(voxels * iterations).
[[nodiscard]] TissueSegmentation segmentTissue(const Volume<float>& intensity,
                                               const Volume<Label>& mask = {},
                                               const TissueOptions& options = {},
                                               const Monitor& monitor = {});

}  // namespace explica::segmentation
