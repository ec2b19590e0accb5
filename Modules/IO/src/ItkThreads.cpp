// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/ItkFormats.h"

#include <itkMultiThreaderBase.h>

#include <algorithm>

namespace explica::io {

void setItkThreadCount(int count) {
  const auto threads = static_cast<itk::ThreadIdType>(std::max(count, 1));
  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(threads);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(threads);
}

}  // namespace explica::io
