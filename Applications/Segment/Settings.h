// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Segmentation/Hemisphere.h"
#include "Explica/Segmentation/Tissue.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// Whether a T1 has its skull.
enum class Stripped { Yes, No, Auto };
constexpr auto enumWords(Stripped) {
  using enum Stripped;
  return std::to_array<EnumWord<Stripped>>({{Yes, "yes"}, {No, "no"}, {Auto, "auto"}});
}

}  // namespace explica::app

namespace explica::app {

/// What the options of `explica segment` set.
struct SegmentSettings {
  std::string image;
  std::optional<std::string> mask;
  std::optional<std::string> atlas;
  std::optional<std::string> legend;
  std::optional<std::string> headTemplate;
  std::optional<std::string> templateTransform;
  Stripped stripped = Stripped::Auto;
  io::VolumeReadOptions reading;
  segmentation::TissueOptions tissue;
  segmentation::HemisphereOptions hemisphere{.side = segmentation::Side::Both};
  std::vector<std::string> accept;
};

void declareSegment(Declaration& d, SegmentSettings& s);

}  // namespace explica::app
