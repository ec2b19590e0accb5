// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace explica {

/// Whether there is such a file or folder; false, too, where nobody can tell: a loop of links, a
/// folder that may not be read.  Who opens it then says why it cannot be opened.
[[nodiscard]] bool isThere(const std::filesystem::path& path);

/// The same for a folder.
[[nodiscard]] bool isFolder(const std::filesystem::path& path);

/// Paths of a folder's entries, by name: those whose names are wanted.  None if there is no folder.
[[nodiscard]] std::vector<std::filesystem::path> entriesOf(
    const std::filesystem::path& folder,
    const std::function<bool(const std::string& name)>& wanted = {});

/// Those of them that are folders.
[[nodiscard]] std::vector<std::filesystem::path> foldersOf(
    const std::filesystem::path& folder,
    const std::function<bool(const std::string& name)>& wanted = {});

}  // namespace explica
