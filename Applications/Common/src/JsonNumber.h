// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Document.h"

#include <cmath>

namespace explica::app {

/// JSON has no NaN and no infinity: null instead.
inline provenance::Json numberOrNull(double value) {
  return std::isfinite(value) ? provenance::Json(value) : provenance::Json(nullptr);
}

}  // namespace explica::app
