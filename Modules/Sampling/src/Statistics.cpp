// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Statistics.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

namespace explica::sampling {
namespace {

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

/// Sums of the values that are known and wanted: lanes side by side, which one instruction adds.
Sums sumsOf(std::span<const float> values, const std::vector<std::uint8_t>& wanted) {
  constexpr std::size_t kLanes = 8;
  std::size_t first = 0;
  while (first < wanted.size() && !(wanted[first] && values[first] == values[first])) ++first;
  Sums all;
  if (first == wanted.size()) return all;
  all.shift = values[first];
  std::array<double, kLanes> sum{}, squares{};
  std::array<std::uint32_t, kLanes> count{};
  const auto add = [&](std::size_t v, std::size_t lane) {
    const bool known = wanted[v] != 0 && values[v] == values[v];
    const double x = known ? values[v] - all.shift : 0;
    sum[lane] += x;
    squares[lane] += x * x;
    count[lane] += known;
  };
  const std::size_t even = wanted.size() / kLanes * kLanes;
  for (std::size_t v = 0; v < even; v += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(v + lane, lane);
  }
  for (std::size_t v = even; v < wanted.size(); ++v) add(v, v - even);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    all.sum += sum[lane];
    all.squares += squares[lane];
    all.count += count[lane];
  }
  return all;
}

}  // namespace

std::vector<float> acrossDepths(std::span<const float> values, std::size_t depths, Across across) {
  const std::size_t count = depths == 0 ? 0 : values.size() / depths;
  std::vector<float> result(count, std::numeric_limits<float>::quiet_NaN());
  parallelFor(count, [&](std::size_t v) {
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
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::abs(static_cast<double>(a) - middle) < std::abs(static_cast<double>(b) - middle);
  });
  std::vector<Label> result(count, kNoLabel);
  parallelFor(count, [&](std::size_t v) {
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
      if (std::ranges::find(one.keys, entry.key) == one.keys.end()) continue;
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
  sums.back() = sumsOf(values, inAny_);
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
