// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica {

/// From here on the process keeps the memory that it frees for what it allocates next, so that the
/// system need not clear new pages for every array of every part of a computation.  Does nothing
/// where the C library is not glibc.
void keepFreedMemory();

/// Eigen cuts products of matrices into blocks that suit the processor's caches and adds up block
/// by block, so that the last digits depend on the processor; after this call the blocks suit
/// caches of one size, in the whole program.
void fixBlocksOfProducts();

}  // namespace explica
