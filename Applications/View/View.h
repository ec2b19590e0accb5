// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Steer.h"

namespace explica::app {

/// `explica view` in a program that has a window.  Without one (`show` is empty) the command hands
/// itself to the program explica-window.
Command viewCommandShowing(ShowWindow show);

}  // namespace explica::app
