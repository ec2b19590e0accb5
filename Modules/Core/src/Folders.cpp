// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Folders.h"

#include <algorithm>
#include <system_error>

namespace explica {

namespace fs = std::filesystem;

bool isThere(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

bool isFolder(const fs::path& path) {
  std::error_code unknown;
  return fs::is_directory(path, unknown);
}

std::vector<fs::path> entriesOf(const fs::path& folder,
                                const std::function<bool(const std::string&)>& wanted) {
  std::vector<fs::path> entries;
  std::error_code absent;
  for (const auto& entry : fs::directory_iterator(folder, absent)) {
    if (!wanted || wanted(entry.path().filename().string())) entries.push_back(entry.path());
  }
  std::ranges::sort(entries);
  return entries;
}

std::vector<fs::path> foldersOf(const fs::path& folder,
                                const std::function<bool(const std::string&)>& wanted) {
  std::vector<fs::path> folders = entriesOf(folder, wanted);
  std::erase_if(folders, [](const fs::path& entry) { return !isFolder(entry); });
  return folders;
}

}  // namespace explica
