// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Core/Text.h"
#include "Explica/Study/StudyTable.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// What `study group` and `bids ... group` may be told.
struct GroupSettings {
  std::vector<std::string> include;  ///< people who count although their run is doubted
  std::optional<std::string> model;
  double fwhm = 10;  ///< mm, of the maps that the model is fitted to
};

/// What is known of people, by participant_id and column: participants.tsv.
using AboutPeople = std::map<std::string, TableRow>;

/// Who is in a group's numbers.
struct GroupSummary {
  std::vector<std::string> in, out;  ///< hemispheres, those left out with the reason
  std::string space;                 ///< "space-colin27_den-10k"; empty: nobody is on a template
};
void describe(Results& t, const GroupSummary& g);

void declareGroup(Declaration& d, GroupSettings& s);

/// People on their template, together: writes below `group/` mean, deviation and variation of
/// thickness, sulcal depth and area at every vertex, each person's z-maps, tables of people and of
/// their regions with what is known of them, a picture, and the results of a model.  The rows get
/// each person's distance from the group and what is known of the person.  Then writes the study's
/// tables and page.
/// @throws InvalidInput  names a person whose maps have another template or density, or whom
///                       --include names and who is not there
void writeStudy(Context& context, const GroupSettings& settings, const AboutPeople& about,
                std::vector<study::StudyRow>& rows, const std::string& title);

}  // namespace explica::app
