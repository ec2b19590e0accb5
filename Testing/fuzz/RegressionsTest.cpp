// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What once crashed a reader is tried by every build: the files of regressions/<reader>.

#include "Readers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace explica::fuzz {
namespace {

namespace fs = std::filesystem;

TEST(FuzzRegressions, GetAnAnswer) {
  for (const auto& folder : fs::directory_iterator(EXPLICA_REGRESSIONS)) {
    const std::string name = folder.path().filename().string();
    const auto reader = std::find_if(allReaders().begin(), allReaders().end(),
                                     [&](const Reader& r) { return r.name == name; });
    ASSERT_NE(reader, allReaders().end()) << name;
    const Trial trial(*reader);
    for (const auto& entry : fs::directory_iterator(folder)) {
      SCOPED_TRACE(entry.path());
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string text((std::istreambuf_iterator<char>(file)), {});
      ASSERT_FALSE(text.empty());
      EXPECT_NO_THROW(trial.read(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    }
  }
}

}  // namespace
}  // namespace explica::fuzz
