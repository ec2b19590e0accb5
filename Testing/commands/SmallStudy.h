// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Testing/Command.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace explica::testing {

/// A BIDS data set of phantoms, one hemisphere each, that `explica bids` takes through in a second.
class SmallStudy {
 public:
  /// @param folder  where `data` will be, and `out` by default
  SmallStudy(std::filesystem::path folder, const std::vector<std::string>& subjects)
      : folder_(std::move(folder)) {
    const std::string phantom = (folder_ / "phantom").string();
    const CommandResult made =
        explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", phantom});
    if (made.exitCode != 0) throw std::runtime_error(made.err);
    for (const std::string& subject : subjects) {
      std::filesystem::create_directories(labels(subject).parent_path());
      std::filesystem::copy_file(phantom + "/labels.nii.gz", labels(subject));
    }
    writeText(folder_ / "data/dataset_description.json",
              R"({"Name": "phantoms", "BIDSVersion": "1.8.0", "License": "CC0"})");
  }

  [[nodiscard]] std::filesystem::path labels(const std::string& subject) const {
    return folder_ / "data" / ("sub-" + subject) / "anat" / ("sub-" + subject + "_dseg.nii.gz");
  }
  [[nodiscard]] std::string data() const { return (folder_ / "data").string(); }
  [[nodiscard]] std::string out() const { return (folder_ / "out").string(); }

  /// The command line of the participant level.
  [[nodiscard]] std::vector<std::string> participants(const std::string& out,
                                                      std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"bids",         data(),    out,
                                      "participant",  "--steps", "thickness,surface",
                                      "--hemisphere", "L",       "--surface.faces",
                                      "1000"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] std::vector<std::string> group(const std::string& out) const {
    return {"bids", data(), out, "group"};
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace explica::testing
