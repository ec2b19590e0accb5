// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/ItkFormats.h"

#include <gtest/gtest.h>
#include <itkMultiThreaderBase.h>

namespace explica::io {
namespace {

TEST(ItkThreads, FollowTheLimitUpAndDown) {
  for (const int count : {3, 1, 2}) {
    setItkThreadCount(count);
    EXPECT_EQ(itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads(), count);
  }
}

}  // namespace
}  // namespace explica::io
