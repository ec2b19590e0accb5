// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Correspondence/AnatomicalGrid.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/ImageEdge.h"
#include "Explica/Correspondence/Layers.h"
#include "Explica/Correspondence/Ribbon.h"

#include <functional>
#include <optional>
#include <string>

namespace explica::correspondence {

/// What to do where the banks of a sulcus touch.
enum class SulciMode {
  Recover,  ///< put the outer boundary between them
  Ignore    ///< take the labels as they are
};
constexpr auto enumWords(SulciMode) {
  using enum SulciMode;
  return std::to_array<EnumWord<SulciMode>>({{Recover, "recover"}, {Ignore, "ignore"}});
}

/// Everything that is chosen between the labels and the measures.
struct MeasurementOptions {
  harmonic::AnnulusOptions annulus;
  harmonic::InterpolantOptions interpolant;
  std::optional<SulciMode> sulci;  ///< unset: recover, but ignore with openEnds, and with
                                   ///< perSlice unless the inner region is folded as a cortex's:
                                   ///< the folds of a cavity (papillary muscles) are no sulci
  SulcusOptions sulcus;
  CorrespondenceOptions correspondence;
  LayerOptions layers;
  std::optional<int> grid;  ///< cells across of an anatomical grid; unset: none

  /// @param folding  foldingOf() the tissue
  [[nodiscard]] bool isWall(double folding) const {
    return annulus.openEnds || (annulus.perSlice && folding < kCortex);
  }
  [[nodiscard]] SulciMode sulciMode(double folding) const {
    return sulci.value_or(isWall(folding) ? SulciMode::Ignore : SulciMode::Recover);
  }
  /// Folding that no cavity of a heart has, and every slice of a folded cortex.
  static constexpr double kCortex = 2.5;
};

/// How folded the inner region is within its slices: perimeter squared over 4 pi times the area, 1
/// for a disc; mean over the slices, by area.  0 without an inner voxel.
[[nodiscard]] double foldingOf(const harmonic::Annulus& annulus);

/// Tissue and everything that is measured on it, per tissue number of `annulus`.
struct Measurement : Ribbon {
  Correspondence correspondence;
  std::vector<std::uint8_t> nearEdge;  ///< nearImageEdge(); empty for a ventricle's wall, which a
                                       ///< stack cuts across, and where no tissue meets the edge
  std::size_t cutVoxels = 0;           ///< marked there
  std::size_t lost = 0;                ///< without thickness for no such reason
  std::vector<double> depth;           ///< L0 / thickness
  std::vector<int> layers;             ///< from 1 at the inner boundary; 0: unknown
  bool sulciRecovered = false;         ///< or at least looked for
  std::optional<AnatomicalGrid> grid;
};

/// 1 at voxels whose thickness is known and which the image's edge does not reach.
[[nodiscard]] std::vector<int> validOf(const Measurement& m);

void describe(Results& t, const Measurement& m);

/// Called as each part of the work begins: "sulci", "harmonic", "correspondence", "layers", "grid";
/// with what is known by then.
using OnPart = std::function<void(const std::string& part, const Measurement& sofar)>;

/// From tissue between two boundaries to thickness, depth, layers and what else is asked for: the
/// parts of this module in their order, as `explica thickness` and the Python module run them.
/// @throws InvalidInput  an option out of range
[[nodiscard]] Measurement measure(harmonic::Annulus annulus, const MeasurementOptions& options = {},
                                  const Monitor& monitor = {}, const OnPart& onPart = {});

}  // namespace explica::correspondence
