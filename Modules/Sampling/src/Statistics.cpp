// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Statistics.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace explica::sampling {
namespace {

constexpr std::size_t kGrain = 4096;

/// Sums about a first value, so that a large mean does not swallow the deviation.
struct Sums {
  double shift = kNaN, sum = 0, squares = 0;
  std::size_t count = 0;

  void add(double value) {
    if (count == 0) shift = value;
    const double x = value - shift;
    sum += x;
    squares += x * x;
    ++count;
  }
  [[nodiscard]] Moments moments() const {
    Moments m;
    m.count = count;
    if (count == 0) return m;
    const auto n = static_cast<double>(count);
    m.mean = shift + sum / n;
    if (count > 1) m.deviation = std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1)));
    return m;
  }
};

}  // namespace

std::vector<float> acrossDepths(std::span<const float> values, std::size_t depths, Across across) {
  const std::size_t count = depths == 0 ? 0 : values.size() / depths;
  std::vector<float> result(count, std::numeric_limits<float>::quiet_NaN());
  parallelFor(count, kGrain, [&](std::size_t v) {
    double sum = 0;
    float largest = 0;
    int known = 0;
    for (std::size_t d = 0; d < depths; ++d) {
      const float value = values[d * count + v];
      if (std::isnan(value)) continue;
      largest = known == 0 ? value : std::max(largest, value);
      sum += value;
      ++known;
    }
    if (known > 0) result[v] = across == Across::Max ? largest : static_cast<float>(sum / known);
  });
  return result;
}

std::vector<Label> majorityAcross(std::span<const Label> labels, std::size_t depths) {
  const std::size_t count = depths == 0 ? 0 : labels.size() / depths;
  std::vector<std::size_t> order(depths);
  for (std::size_t d = 0; d < depths; ++d) order[d] = d;
  const double middle = 0.5 * static_cast<double>(depths - 1);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(static_cast<double>(a) - middle) < std::abs(static_cast<double>(b) - middle);
  });
  std::vector<Label> result(count, kNoLabel);
  parallelFor(count, kGrain, [&](std::size_t v) {
    std::size_t most = 0;
    for (const std::size_t d : order) {
      const Label label = labels[d * count + v];
      if (label == kNoLabel) continue;
      std::size_t votes = 0;
      for (std::size_t e = 0; e < depths; ++e) votes += labels[e * count + v] == label;
      if (votes <= most) continue;
      most = votes;
      result[v] = label;
    }
  });
  return result;
}

Regions::Regions(Eigen::Index vertexCount)
    : names_{"all"}, inAny_(static_cast<std::size_t>(vertexCount), 1) {}

Regions::Regions(const std::vector<RegionTable>& parcellations) {
  if (parcellations.empty()) throw InvalidInput("regions: none are given");
  inAny_.assign(parcellations.front().keys.size(), 0);
  for (const RegionTable& one : parcellations) {
    if (one.keys.size() != inAny_.size()) {
      throw InvalidInput("regions: they are given for " + std::to_string(one.keys.size()) +
                         " and for " + std::to_string(inAny_.size()) + " vertices");
    }
    std::map<Label, std::int32_t> number;
    for (const RegionName& entry : one.table) {
      if (std::find(one.keys.begin(), one.keys.end(), entry.key) == one.keys.end()) continue;
      if (!number.emplace(entry.key, static_cast<std::int32_t>(names_.size())).second) continue;
      names_.push_back(entry.name);
    }
    std::vector<std::int32_t>& regionOf = regionOf_.emplace_back(one.keys.size(), -1);
    for (std::size_t v = 0; v < one.keys.size(); ++v) {
      const auto found = number.find(one.keys[v]);
      if (found == number.end()) continue;
      regionOf[v] = found->second;
      inAny_[v] = 1;
    }
  }
  names_.emplace_back("all");
}

std::string Regions::nameAt(std::size_t vertex) const {
  std::string names;
  for (const auto& regionOf : regionOf_) {
    const std::int32_t region = regionOf.at(vertex);
    if (region >= 0) names += (names.empty() ? "" : "; ") + names_[region];
  }
  return names;
}

std::vector<Moments> Regions::momentsOf(std::span<const float> values) const {
  std::vector<Sums> sums(names_.size());
  for (std::size_t v = 0; v < inAny_.size(); ++v) {
    if (inAny_[v] && !std::isnan(values[v])) sums.back().add(values[v]);
  }
  for (const auto& regionOf : regionOf_) {
    for (std::size_t v = 0; v < regionOf.size(); ++v) {
      if (regionOf[v] >= 0 && !std::isnan(values[v])) sums[regionOf[v]].add(values[v]);
    }
  }
  std::vector<Moments> result;
  result.reserve(sums.size());
  for (const Sums& s : sums) result.push_back(s.moments());
  return result;
}

}  // namespace explica::sampling
