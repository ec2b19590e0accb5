// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Provenance/Document.h"

namespace explica::provenance {

/// A result's value: null if it is not known, an object for each part of a list of parts.
[[nodiscard]] Json valueOf(const Result::Value& value);

/// Title, unit, meaning and limits of a result, and, where it has a value, what its limits say of
/// it: {"title", "unit", "meaning", "start", "head", "compared", "limits", "judgement",
/// "sentence", "expected"}; what does not apply is left out.
[[nodiscard]] Json meaningOf(const Result& result);

}  // namespace explica::provenance
