// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Applications/<Name>/README.md follows from the declarations: regenerated here and compared.  With
// EXPLICA_UPDATE_PAGES set (Testing/update-pages.sh) the pages are written instead.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <map>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// The page of each folder under Applications, by its name: kinds of a verb share one.
std::map<std::string, std::string> pages() {
  std::map<std::string, std::string> byFolder;
  for (const auto& command : nlohmann::ordered_json::parse(explica({"--describe"}).out)) {
    const std::string name = command["command"];
    const auto space = name.find(' ');
    std::string folder = name.substr(0, space);
    std::vector<std::string> words = {folder};
    if (space != std::string::npos) words.push_back(name.substr(space + 1));
    words.push_back("--describe=page");
    folder[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(folder[0])));
    std::string& page = byFolder[folder];
    page += (page.empty() ? "" : "\n") + explica(words).out;
  }
  for (auto& [folder, page] : byFolder) {
    page = "<!-- Written by Testing/update-pages.sh from the command's declaration. -->\n" + page;
  }
  return byFolder;
}

TEST(ReferencePages, AreWhatTheDeclarationsSay) {
  const bool update = std::getenv("EXPLICA_UPDATE_PAGES") != nullptr;
  for (const auto& [folder, page] : pages()) {
    const fs::path path = fs::path(EXPLICA_SOURCE_DIR) / "Applications" / folder / "README.md";
    if (update) {
      writeText(path, page);
      continue;
    }
    ASSERT_TRUE(fs::exists(path)) << path << ": run Testing/update-pages.sh";
    EXPECT_EQ(readText(path), page) << path << " is out of date: run Testing/update-pages.sh";
  }
}

}  // namespace
}  // namespace explica::testing
