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

/// Mean of what is known of the ring's segments, by their numbers less one.
template <class ValueOf>
double ringMean(const Ring& ring, const ValueOf& valueOf) {
  double sum = 0;
  int count = 0;
  for (int n = ring.first; n <= ring.last; ++n) {
    const double value = valueOf(static_cast<std::size_t>(n - 1));
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : kNaN;
}

/// End-systole less end-diastole.
double ringThickening(const Beat& beat, const Ring& ring) {
  if (beat.systole == beat.diastole || !beat.atSystole().segments) return kNaN;
  return ringMean(ring, [&](std::size_t s) {
    return beat.atSystole().segments->rows[s].thickness -
           beat.atDiastole().segments->rows[s].thickness;
  });
}

std::string spreadText(const Spread& spread) {
  return cellText(spread.mean, "%g") + " (SD " + cellText(spread.deviation, "%g") + ")";
}

}  // namespace

const std::vector<Reference>& references() {
  using enum Quantity;
  const std::string kawel = "Kawel et al. 2012, Circ Cardiovasc Imaging 5:500";
  const std::string boehm = "Kawel-Boehm et al. 2015, J Cardiovasc Magn Reson 17:29";
  const std::string ubachs = "Ubachs et al. 2009, J Cardiovasc Magn Reson 11(Suppl 1):P61";
  const std::string hudsmith = "Hudsmith et al. 2005, J Cardiovasc Magn Reson 7:775";
  const std::string petersen = "Petersen et al. 2017, J Cardiovasc Magn Reson 19:18";
  const std::string old = "169 women and 131 men, 65.6 years in the mean";
  const std::string young = "20 women and 30 men, 35 years in the mean";
  const std::string oxford = "45 women and 63 men, 21 to 68 years";
  const std::string biobank = "432 women and 368 men, 45 to 74 years";
  const auto row = [](auto... fields) { return Reference{fields...}; };
  const auto sd = [](double mean, double deviation) { return Spread{mean, deviation}; };
  static const std::vector<Reference> all = {
      row(MiddleThickness, "end-diastolic thickness, middle ring", "mm", sd(5.3, 0.9), sd(6.3, 1.1),
          "n/a", old, kawel),
      row(BasalThickening, "thickening, basal ring", "mm", sd(4.3, 1.4), sd(4.3, 1.4), "n/a", young,
          ubachs),
      row(MiddleThickening, "thickening, middle ring", "mm", sd(4.4, 1.4), sd(4.4, 1.4), "n/a",
          young, ubachs),
      row(ApicalThickening, "thickening, apical ring", "mm", sd(3.2, 1.4), sd(3.2, 1.4), "n/a",
          young, ubachs),
      row(DiastolicVolume, "end-diastolic volume of the cavity", "ml", sd(135, 26), sd(160, 29),
          "wall", oxford, hudsmith),
      row(SystolicVolume, "end-systolic volume of the cavity", "ml", sd(42, 12), sd(50, 16), "wall",
          oxford, hudsmith),
      row(Ejection, "ejection fraction", "%", sd(61, 5), sd(58, 5), "cavity", biobank, petersen),
      row(Mass, "mass of the wall", "g", sd(98, 21), sd(134, 21), "wall",
          "adults, several studies together", boehm)};
  return all;
}

const Reference& referenceOf(Quantity quantity) {
  return references()[static_cast<std::size_t>(quantity)];
}

double valueOf(const Beat& beat, Quantity quantity) {
  const bool two = beat.systole != beat.diastole;
  switch (quantity) {
    case Quantity::MiddleThickness:
      return ringMean(kMiddle,
                      [&](std::size_t s) { return beat.atDiastole().segments->rows[s].thickness; });
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
