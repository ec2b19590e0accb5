// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Crossings.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/Unfold.h"

namespace explica::unfolding {

/// What crosses before anything moves, and what a repair has made of it.
struct StartSummary {
  std::size_t crossings = 0;                ///< pairs of faces
  std::optional<std::size_t> inRegion = 0;  ///< of them with a face in the region, if there is one
  std::size_t parted = 0;                   ///< by the repair
  std::size_t moved = 0;                    ///< vertices
  double moveMax = 0, moveMean = 0;         ///< mm
};

/// Frames on the way, as files hold them.
struct FrameSummary {
  std::optional<std::vector<double>> visibilities = std::vector<double>();
  std::optional<std::size_t> mostCrossings = 0;  ///< of any frame
};

/// How the iterations end.
struct EndSummary {
  int iterations = 0;
  Flag flag = Flag::None;
  Termination stopReason = Termination::NotRun;
};

/// An unfolding in numbers, of the surface as files hold it.
struct UnfoldSummary {
  std::string reference = "SURFACE";  ///< the file of the surface that this compares with
  Surround surround = Surround::Elastic;
  visibility::Viewpoints view;
  double target = 1;  ///< visibility that was asked for
  std::size_t regionFaces = 0, regionVertices = 0;
  int regionPieces = 0, regionHoles = 0;
  double regionArea = kNaN;  ///< mm^2
  Change visibility, fluxVariance, seen, realVisibility, backfacing;
  Distortion distortion;
  std::size_t collarFaces = 0;
  std::optional<double> collarStretchMean = kNaN, collarStretchMax = kNaN;
  std::size_t crossings = 0, crossingsNew = 0, crossingsWithRest = 0;  ///< pairs of faces
  FrameSummary frames;
  int iterationWritten = 0;
  PhaseSeconds phases;
  double secondsPerIteration = 0;
  EndSummary end;
};

void describe(Results& t, const StartSummary& s);
void describe(Results& t, const FrameSummary& s);
void describe(Results& t, const EndSummary& s);
void describe(Results& t, const UnfoldSummary& s);

}  // namespace explica::unfolding
