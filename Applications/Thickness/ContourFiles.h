// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Correspondence/Measurement.h"

namespace explica::app {

/// Contours of tissue whose slices stand alone, as a table and as lines.
void writeContours(Context& context, const correspondence::Measurement& m);

}  // namespace explica::app
