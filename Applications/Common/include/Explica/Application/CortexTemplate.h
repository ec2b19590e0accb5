// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// The template that is used where none is named: Colin27 of the Debian package mricron-data.
inline constexpr const char* kDefaultTemplate = "colin27";
inline constexpr const char* kNoTemplate = "none";

/// What a template holds of one hemisphere.
struct CortexTemplate {
  std::string sphere;               ///< in register with all that is registered to the template
  std::string sulc, curvature;      ///< sulcal depth (mm) and mean curvature (1/mm) at its vertices
  std::string sulcSd, curvatureSd;  ///< their deviations between people; empty: not known
  std::string atlas, white, pial;   ///< of the same vertices; empty: not there
  std::string cuts;                 ///< medial wall (1) and cuts (2 and on) of flat maps, if there
};

/// The first of the names that is a file in one of the folders.
[[nodiscard]] std::optional<std::string> findFile(const std::vector<std::string>& folders,
                                                  const std::vector<std::string>& names);

/// A folder of surfaces and, beside a `surface*` folder of explica run, the `register*` folder of
/// that hemisphere.
[[nodiscard]] std::vector<std::string> withRegistration(const std::string& folder);

/// True if the template can be had: Colin27's volumes are installed, or it is another one.
[[nodiscard]] bool hasTemplate(const std::string& name);

/// The template's files of a hemisphere.
///
/// A template is a folder: of FreeSurfer's form (lh.sphere.reg, lh.sulc, lh.curv, lh.aparc.annot,
/// there or in `surf` and `label`), or what `explica run` has left of a person (sphere-L,
/// surface-L).  A name is that of a subject in $SUBJECTS_DIR, or `colin27`: what `explica run`
/// makes of Colin27 and its AAL labels, once, in $EXPLICA_CACHE, else $XDG_CACHE_HOME/explica, else
/// ~/.cache/explica.
/// @param structure  "CortexLeft" or "CortexRight"
/// @throws InvalidInput  no such template, or a file of it missing
/// @throws EnvironmentError  there is no place for what is made
[[nodiscard]] CortexTemplate findTemplate(Context& context, const std::string& name,
                                          const std::string& structure);

}  // namespace explica::app
