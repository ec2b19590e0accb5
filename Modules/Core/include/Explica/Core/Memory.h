// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica {

/// From here on the process keeps the memory that it frees for what it allocates next, so that the
/// system need not clear new pages for every array of every part of a computation.  Does nothing
/// where the C library is not glibc.
void keepFreedMemory();

}  // namespace explica
