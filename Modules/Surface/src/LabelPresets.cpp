// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LabelPresets.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <initializer_list>
#include <set>

namespace explica::surface {
namespace {

/// Labels from `first` to `last`.
struct Range {
  Label first, last;
  constexpr Range(Label label) : first(label), last(label) {}
  constexpr Range(Label from, Label to) : first(from), last(to) {}
};
using Ranges = std::vector<Range>;

/// What one program's labels mean; what is not named lies outside.
struct Row {
  LabelPreset preset;
  struct Hemisphere {
    Ranges white, grey, fill;
  };
  Hemisphere left;  ///< of both sides, if they have no labels of their own
  Hemisphere right = {};
  Ranges unsided = {};
  Ranges insulated = {};
  Ranges outside;  ///< what its programs use besides
  bool borderLines = false;
};

/// FreeSurfer's colour table beside the cerebrum: structures of aseg with the numbers of old
/// versions, air and skull (130, 165), brain stem and vermis (170 to 175), callosum as one (192),
/// what lies around the brain (257 to 259), cerebellar lobules (600 to 628), limbic structures (801
/// to 870).
const Ranges kFreeSurferOutside = {{1, 99}, 130,        165,        {170, 175},
                                   192,     {250, 260}, {600, 628}, {801, 870}};

/// The presets, one table for all programs.
const std::vector<Row>& rows() {
  static const std::vector<Row> table = {
      // FreeSurfer's colour table: aseg, aparc+aseg (Desikan 1000, Destrieux 11100 and, before
      // version 5, 1100), wmparc (3000, 13100, 5001); SynthSeg, FastSurfer and infant FreeSurfer
      // use the same numbers. Filled are ventricles, thalamus (old and new number), caudate,
      // putamen, pallidum, hippocampus, amygdala, accumbens, ventral diencephalon, vessel, choroid
      // plexus, hypointensities. Without side are callosum, fornix, hypointensities and the fifth
      // ventricle; insulated brain stem, and what infant FreeSurfer parts it into.
      {LabelPreset::Aseg,
       {{2, {3000, 3035}, {13100, 13175}, {3100, 3181}, 5001},
        {3, {1000, 1035}, {11100, 11175}, {1100, 1181}},
        {4, 5, {9, 13}, 17, 18, 26, 28, 30, 31, 78, 81}},
       {{41, {4000, 4035}, {14100, 14175}, {4100, 4181}, 5002},
        {42, {2000, 2035}, {12100, 12175}, {2100, 2181}},
        {43, 44, {48, 52}, 53, 54, 58, 60, 62, 63, 79, 82}},
       {72, 77, 80, {250, 255}},
       {16, {173, 175}},
       kFreeSurferOutside},
      // FreeSurfer's and the Human Connectome Project's ribbon, filled by its program.
      {LabelPreset::Ribbon,
       {{2, {3000, 3035}, 5001}, {3, {1000, 1035}, {11100, 11175}}, {}},
       {{41, {4000, 4035}, 5002}, {42, {2000, 2035}, {12100, 12175}}, {}},
       {},
       {16},
       kFreeSurferOutside},
      // Fluid, grey, white, and a cut where `explica segment` makes one; FAST, SPM, CAT12, CIVET
      // and iBEAT number the classes alike.
      {LabelPreset::ThreeClass, {{3}, {2}, {}}, {}, {}, {4}, {1}},
      // Six classes of antsCorticalThickness and Atropos: 4 deep grey matter, 5 brain stem, 6
      // cerebellum.
      {LabelPreset::Ants, {{3}, {2}, {4}}, {}, {}, {5}, {1, 6}},
      // The nine classes of dHCP (Draw-EM): 5 ventricles, 7 deep grey matter, 8 brain stem, 9
      // hippocampus and amygdala.
      {LabelPreset::Dhcp, {{3}, {2}, {5, 7, 9}}, {}, {}, {8}, {1, 4, 6}},
      // The 87 structures of dHCP (Draw-EM): up to 16 and in white matter up to 62 odd numbers are
      // left, beyond even ones are right but for the ventricles; 48 callosum, 19 brain stem.
      {LabelPreset::Dhcp87,
       {{51, 53, 55, 57, 59, 61, 64, 66, 68, 70, 72, 74, 76, 78, 80, 82},
        {5, 7, 9, 11, 13, 15, 21, 23, 25, 27, 29, 31, 33, 35, 37, 39},
        {1, 3, 41, 43, 45, 47, 49, 87}},
       {{52, 54, 56, 58, 60, 62, 63, 65, 67, 69, 71, 73, 75, 77, 79, 81},
        {6, 8, 10, 12, 14, 16, 20, 22, 24, 26, 28, 30, 32, 34, 36, 38},
        {2, 4, 40, 42, 44, 46, 50, 86}},
       {48},
       {19},
       {{17, 18}, {83, 85}}},
      // NIMH Macaque Template, version 2: fluid, deep grey matter, cortex, white matter, vessels.
      {LabelPreset::Nmt, {{4}, {3}, {2}}, {}, {}, {}, {1, 5}},
      // LayNii's rim: 1 border line to fluid, 2 border line to white matter, 3 grey matter.
      {LabelPreset::LayNii, {{2}, {3}, {}}, {}, {}, {0}, {1}, true},
      // FreeSurfer's filled; wm has white matter only, from 5 on.
      {LabelPreset::Wm, {{255}, {}, {}}, {{127}, {}, {}}, {}, {}, {{1, 255}}}};
  return table;
}

const Row& rowOf(LabelPreset preset) {
  for (const Row& row : rows()) {
    if (row.preset == preset) return row;
  }
  throw InvalidInput("labels: no table for this preset");
}

Labels present(const Ranges& ranges, const Histogram& histogram) {
  Labels labels;
  for (const Range& range : ranges) {
    const auto end = histogram.upper_bound(range.last);
    for (auto it = histogram.lower_bound(range.first); it != end; ++it) labels.push_back(it->first);
  }
  return labels;
}

Labels presentOrFirst(const Ranges& ranges, const Histogram& histogram) {
  Labels labels = present(ranges, histogram);
  if (labels.empty() && !ranges.empty()) labels.push_back(ranges.front().first);
  return labels;
}

/// Faces between voxels of two labels.
std::int64_t contactsOf(const Volume<Label>& labels, Label one, Label other) {
  std::int64_t contacts = 0;
  forContacts(labels, [&](Label a, Label b) {
    contacts += (a == one && b == other) || (a == other && b == one);
  });
  return contacts;
}

/// LayNii's border lines run on both sides of grey matter, so that they hardly meet; where 1 is
/// fluid and 2 grey matter, these share the whole outer border.
bool drawsBorderLines(const Volume<Label>& labels) {
  constexpr std::int64_t kFew = 20;  // to one
  return contactsOf(labels, 1, 2) * kFew < contactsOf(labels, 1, 3);
}

}  // namespace

Histogram histogramOf(const Volume<Label>& labels) {
  Histogram counts;
  Label last = 0;
  std::int64_t run = 0;
  for (const Label value : labels.data) {
    if (value != last) {
      counts[last] += run;
      last = value;
      run = 0;
    }
    ++run;
  }
  counts[last] += run;
  std::erase_if(counts, [](const auto& entry) { return entry.second == 0; });
  return counts;
}

std::string listOf(const Histogram& histogram) {
  std::string text;
  int listed = 0;
  for (const auto& [label, count] : histogram) {
    if (++listed > 24) return text + ", ...";
    if (!text.empty()) text += ", ";
    text += std::to_string(label);
  }
  return text;
}

std::int64_t countOf(const Histogram& histogram, const Labels& labels) {
  std::int64_t sum = 0;
  for (const Label label : std::set<Label>(labels.begin(), labels.end())) {
    const auto it = histogram.find(label);
    if (it != histogram.end()) sum += it->second;
  }
  return sum;
}

PresetLabels labelsOf(LabelPreset preset, const Histogram& histogram) {
  const Row& row = rowOf(preset);
  const auto side = [&](const Row::Hemisphere& of) {
    return PresetLabels::Hemisphere{presentOrFirst(of.white, histogram),
                                    presentOrFirst(of.grey, histogram),
                                    present(of.fill, histogram)};
  };
  PresetLabels labels;
  labels.left = side(row.left);
  labels.right = side(row.right);
  labels.unsided = present(row.unsided, histogram);
  labels.insulated = present(row.insulated, histogram);
  labels.sided = !row.right.white.empty();
  labels.borderLines = row.borderLines;
  return labels;
}

Labels unknownTo(LabelPreset preset, const Histogram& histogram) {
  if (preset == LabelPreset::None) return {};
  const Row& row = rowOf(preset);
  std::set<Label> known = {0};
  for (const Ranges* ranges :
       {&row.left.white, &row.left.grey, &row.left.fill, &row.right.white, &row.right.grey,
        &row.right.fill, &row.unsided, &row.insulated, &row.outside}) {
    const Labels of = present(*ranges, histogram);
    known.insert(of.begin(), of.end());
  }
  Labels unknown;
  for (const auto& [label, count] : histogram) {
    if (!known.contains(label)) unknown.push_back(label);
  }
  return unknown;
}

LabelPreset guessPreset(const Volume<Label>& labels, const Histogram& histogram) {
  const auto has = [&](Label label) { return histogram.contains(label); };
  const auto hasAll = [&](std::initializer_list<Label> wanted) {
    return std::all_of(wanted.begin(), wanted.end(), has);
  };
  const Label last = histogram.rbegin()->first;
  // FreeSurfer gives label 1 to nothing.
  if (hasAll({1, 2, 3}) && last <= 4) {
    return last == 3 && drawsBorderLines(labels) ? LabelPreset::LayNii : LabelPreset::ThreeClass;
  }
  if (hasAll({1, 2, 3, 4, 5, 6}) && last == 6) return LabelPreset::Ants;
  if (hasAll({1, 2, 3, 5, 6, 7, 8, 9}) && last == 9) return LabelPreset::Dhcp;
  if (hasAll({1, 2, 20, 21, 51, 52, 79, 80}) && last <= 87) return LabelPreset::Dhcp87;
  const PresetLabels aseg = labelsOf(LabelPreset::Aseg, histogram);
  const auto hasBoth = [&](Side side) {
    return has(aseg.of(side).white.front()) && has(aseg.of(side).grey.front());
  };
  const bool alien = has(1) && last < 41;
  const bool freeSurfer = !alien && (hasBoth(Side::Left) || hasBoth(Side::Right));
  if (freeSurfer && (has(41) || has(10) || has(4))) {
    return has(10) || has(49) || has(4) || has(43) ? LabelPreset::Aseg : LabelPreset::Ribbon;
  }
  if (has(2) && has(3) && last <= 4) return LabelPreset::ThreeClass;
  if (has(110) || (has(127) && has(255))) return LabelPreset::Wm;
  if (freeSurfer) return LabelPreset::Ribbon;
  throw InvalidInput("labels: no preset fits (found " + listOf(histogram) +
                     "); name --white and --grey");
}

}  // namespace explica::surface
