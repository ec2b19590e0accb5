// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Ventricle/Beat.h"

namespace explica::ventricle {

/// A heart in numbers.
struct HeartSummary {
  std::string labels;          ///< which convention
  const Beat* beat = nullptr;  ///< must outlive this
  double openShare = kNaN;     ///< of the cavity's surface at end-diastole
  std::int64_t islands = 0;    ///< voxels that takeOutIslands() took
};

void describe(Results& t, const HeartSummary& s);

}  // namespace explica::ventricle
