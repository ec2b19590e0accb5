// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace explica {

/// Paths of a folder's entries, by name: those whose names are wanted.  None if there is no folder.
[[nodiscard]] std::vector<std::filesystem::path> entriesOf(
    const std::filesystem::path& folder,
    const std::function<bool(const std::string& name)>& wanted = {});

/// Those of them that are folders.
[[nodiscard]] std::vector<std::filesystem::path> foldersOf(
    const std::filesystem::path& folder,
    const std::function<bool(const std::string& name)>& wanted = {});

}  // namespace explica
