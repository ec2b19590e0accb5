// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Plausible.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Results.h"
#include "Explica/Segmentation/Plausibility.h"
#include "Meeting.h"

namespace explica::app {
void declareAccept(Declaration& d, std::vector<std::string>& accepted) {
  static const std::string help =
      "go on although this number is implausible; may be repeated: " +
      joined(segmentation::limits(), ", ", [](const auto& limit) { return limit.name; }) +
      "; or although files are of two hemispheres (hemisphere) or meshes (mesh)";
  d.category("Plausibility").option("accept", help, accepted);
}

Judge::Judge(Context& context, std::vector<std::string> accepted)
    : context_(context), accepted_(std::move(accepted)) {
  for (const char* ofFiles : {kAcceptHemisphere, kAcceptMesh}) std::erase(accepted_, ofFiles);
  try {
    segmentation::checkAccepted(accepted_);
  } catch (const InvalidInput& fault) {
    throw UsageError(fault.what());
  }
  context_.judged();
}

void Judge::require(std::string_view name, double value) {
  const auto flag = segmentation::judge(name, value, accepted_);
  if (!flag) return;
  if (!flag->accepted) {
    throw InvalidInput(flag->sentence + "; --accept " + flag->name + " goes on all the same");
  }
  this->flag(name, value);
}

void Judge::flag(std::string_view name, double value) {
  const auto flag = segmentation::judge(name, value, accepted_);
  if (!flag) return;
  context_.flag({{"name", flag->name},
                 {"value", provenance::valueOf(Result::Value(flag->value))},
                 {"low", provenance::valueOf(Result::Value(flag->low))},
                 {"high", provenance::valueOf(Result::Value(flag->high))},
                 {"accepted", flag->accepted},
                 {"message", flag->sentence}});
}

}  // namespace explica::app
