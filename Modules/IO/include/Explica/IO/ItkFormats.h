// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::io {

/// Makes MGH and MGZ known to every itk::ImageFileReader and itk::ImageFileWriter of this process.
/// Safe to call again.
void registerMghWithItk();

/// Limits every later use of ITK in this process to so many threads, whatever the environment says.
void setItkThreadCount(int count);
[[nodiscard]] int itkThreadCount();

}  // namespace explica::io
