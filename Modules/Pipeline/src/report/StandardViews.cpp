// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "StandardViews.h"

namespace explica::pipeline {

using report::ViewName;

std::vector<std::pair<std::string, ViewName>> standardViews(const std::string& side) {
  const bool right = side == "right";
  return {{"lateral", right ? ViewName::Right : ViewName::Left},
          {"medial", right ? ViewName::Left : ViewName::Right},
          {"dorsal", ViewName::Top},
          {"ventral", ViewName::Bottom},
          {"frontal", ViewName::Front},
          {"occipital", ViewName::Back}};
}

report::SurfacePictureOptions viewSize() {
  return report::SurfacePictureOptions{.width = 300, .height = 230};
}

}  // namespace explica::pipeline
