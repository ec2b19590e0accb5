// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Reference.h"

#include "Explica/Core/Text.h"

#include <cmath>

namespace explica::ventricle {

namespace {

/// First and last segment of a ring.
struct Ring {
  int first, last;
};
constexpr Ring kBasal{1, 6}, kMiddle{7, 12}, kApical{13, 16};  // AHA's numbers

/// Mean over the ring's segments that have a number.
double ringMean(const Frame& frame, const Ring& ring) {
  double sum = 0;
  int count = 0;
  for (const Segment& row : frame.segments->rows) {
    if (row.number < ring.first || row.number > ring.last || !std::isfinite(row.thickness)) {
      continue;
    }
    sum += row.thickness;
    ++count;
  }
  return count > 0 ? sum / count : kNaN;
}

/// Mean of end-systole less end-diastole over the ring's segments that have both.
double ringThickening(const Beat& beat, const Ring& ring) {
  if (beat.systole == beat.diastole || !beat.atSystole().segments) return kNaN;
  double sum = 0;
  int count = 0;
  for (int n = ring.first; n <= ring.last; ++n) {
    const auto s = static_cast<std::size_t>(n - 1);
    const double change = beat.atSystole().segments->rows[s].thickness -
                          beat.atDiastole().segments->rows[s].thickness;
    if (!std::isfinite(change)) continue;
    sum += change;
    ++count;
  }
  return count > 0 ? sum / count : kNaN;
}

std::string spreadText(const Spread& spread) {
  return cellText(spread.mean, "%g") + " (SD " + cellText(spread.deviation, "%g") + ")";
}

}  // namespace

const std::vector<Reference>& references() {
  const std::string kawel = "Kawel et al. 2012, Circ Cardiovasc Imaging 5:500";
  const std::string ubachs = "Ubachs et al. 2009, J Cardiovasc Magn Reson 11(Suppl 1):P61";
  const std::string hudsmith = "Hudsmith et al. 2005, J Cardiovasc Magn Reson 7:775";
  const std::string young = "20 women and 30 men, 35 years in the mean";
  const std::string oxford = "45 women and 63 men, 21 to 68 years";
  static const std::vector<Reference> all = {
      {Quantity::MiddleThickness,
       "end-diastolic thickness, middle ring",
       "mm",
       {5.3, 0.9},
       {6.3, 1.1},
       "n/a",
       "169 women and 131 men, 65.6 years in the mean",
       kawel},
      {Quantity::BasalThickening,
       "thickening, basal ring",
       "mm",
       {4.3, 1.4},
       {4.3, 1.4},
       "n/a",
       young,
       ubachs},
      {Quantity::MiddleThickening,
       "thickening, middle ring",
       "mm",
       {4.4, 1.4},
       {4.4, 1.4},
       "n/a",
       young,
       ubachs},
      {Quantity::ApicalThickening,
       "thickening, apical ring",
       "mm",
       {3.2, 1.4},
       {3.2, 1.4},
       "n/a",
       young,
       ubachs},
      {Quantity::DiastolicVolume,
       "end-diastolic volume of the cavity",
       "ml",
       {135, 26},
       {160, 29},
       "wall",
       oxford,
       hudsmith},
      {Quantity::SystolicVolume,
       "end-systolic volume of the cavity",
       "ml",
       {42, 12},
       {50, 16},
       "wall",
       oxford,
       hudsmith},
      {Quantity::Ejection,
       "ejection fraction",
       "%",
       {61, 5},
       {58, 5},
       "cavity",
       "432 women and 368 men, 45 to 74 years",
       "Petersen et al. 2017, J Cardiovasc Magn Reson 19:18"},
      {Quantity::Mass,
       "mass of the wall",
       "g",
       {98, 21},
       {134, 21},
       "wall",
       "adults, several studies together",
       "Kawel-Boehm et al. 2015, J Cardiovasc Magn Reson 17:29"}};
  return all;
}

const Reference& referenceOf(Quantity quantity) {
  return references()[static_cast<std::size_t>(quantity)];
}

double valueOf(const Beat& beat, Quantity quantity) {
  const bool two = beat.systole != beat.diastole;
  switch (quantity) {
    case Quantity::MiddleThickness:
      return ringMean(beat.atDiastole(), kMiddle);
    case Quantity::BasalThickening:
      return ringThickening(beat, kBasal);
    case Quantity::MiddleThickening:
      return ringThickening(beat, kMiddle);
    case Quantity::ApicalThickening:
      return ringThickening(beat, kApical);
    case Quantity::DiastolicVolume:
      return beat.atDiastole().cavity;
    case Quantity::SystolicVolume:
      return two ? beat.atSystole().cavity : kNaN;
    case Quantity::Ejection:
      return beat.ejectionFraction.value_or(kNaN);
    case Quantity::Mass:
      return beat.atDiastole().mass;
  }
  return kNaN;
}

std::string rangeText(const Reference& reference) {
  const std::string women = spreadText(reference.women), unit = " " + reference.unit;
  if (reference.bothAlike()) return women + unit;
  return "women " + women + ", men " + spreadText(reference.men) + unit;
}

std::string referenceTable(const Beat& beat) {
  std::string text =
      "quantity\tunit\there\twomen_mean\twomen_sd\twomen_z\tmen_mean\tmen_sd\tmen_z\tpapillary_"
      "muscles\tpeople\tsource\n";
  for (const Reference& r : references()) {
    const double here = valueOf(beat, r.quantity);
    text += r.name + '\t' + r.unit + '\t' + cellText(here, "%.3f");
    for (const Spread& s : {r.women, r.men}) {
      text += '\t' + cellText(s.mean, "%g") + '\t' + cellText(s.deviation, "%g") + '\t' +
              cellText((here - s.mean) / s.deviation, "%.2f");
    }
    text += '\t' + r.papillary + '\t' + r.people + '\t' + r.source + '\n';
  }
  return text;
}

}  // namespace explica::ventricle
