// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::io {

/// Limits every later use of ITK in this process to so many threads, whatever the environment says.
void setItkThreadCount(int count);

}  // namespace explica::io
