// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Describe.h"
#include "Explica/Core/Termination.h"

#include <gtest/gtest.h>

namespace explica {
namespace {

TEST(EnumWords, EveryNameRoundTrips) {
  for (const auto& [value, name] : enumWords(Termination{})) {
    EXPECT_EQ(valueOf<Termination>(name), value);
    EXPECT_EQ(nameOf(value), name);
  }
}

TEST(EnumWords, UnknownWordListsTheChoices) {
  try {
    (void)valueOf<Termination>("tired");
    FAIL() << "no exception";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("max-iterations"), std::string::npos);
  }
}

}  // namespace
}  // namespace explica
