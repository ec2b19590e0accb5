// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Tfce.h"

#include <algorithm>

namespace explica::statistics {

Tfce::Tfce(const geometry::IndexLists& neighbours, const std::vector<float>& areas)
    : neighbours_(neighbours),
      areas_(areas),
      parent_(areas.size()),
      gathered_(areas.size()),
      since_(areas.size()),
      extent_(areas.size()) {}

void Tfce::enhance(std::span<const float> values, std::span<float> enhanced) {
  std::fill(enhanced.begin(), enhanced.end(), 0.0F);
  enhanceSide(values, 1, enhanced);
  enhanceSide(values, -1, enhanced);
}

void Tfce::enhanceSide(std::span<const float> values, float sign, std::span<float> enhanced) {
  order_.clear();
  std::fill(parent_.begin(), parent_.end(), -1);
  for (std::size_t v = 0; v < values.size(); ++v) {
    const float height = sign * values[v];
    if (height > 0) order_.emplace_back(-height, static_cast<std::int32_t>(v));
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [negative, v] : order_) {
    const double height = -static_cast<double>(negative);
    add(v, height * height * height / 3);
  }
  // A member's value is its own offset and those on the way to its root.
  for (const auto& [negative, v] : order_) {
    const std::int32_t root = rootOf(v);
    if (since_[root] != 0) gather(root, 0);
    const double above = root == v ? 0 : gathered_[root];
    enhanced[v] = sign * static_cast<float>(gathered_[v] + above);
  }
}

void Tfce::add(std::int32_t v, double integral) {
  const auto i = static_cast<std::size_t>(v);
  parent_[i] = v;
  gathered_[i] = 0;
  since_[i] = integral;
  extent_[i] = areas_[i];
  for (const std::int32_t w : neighbours_[i]) {
    if (parent_[w] < 0) continue;
    join(rootOf(v), rootOf(w), integral);
  }
}

/// Adds to a root what its cluster gains down to a threshold.
void Tfce::gather(std::int32_t root, double integral) {
  const auto r = static_cast<std::size_t>(root);
  gathered_[r] += extent_[r] * (since_[r] - integral);
  since_[r] = integral;
}

/// The root of v; on the way v becomes its child, with the offset to it.
std::int32_t Tfce::rootOf(std::int32_t v) {
  std::int32_t root = v;
  double offset = 0;
  while (parent_[root] != root) {
    offset += gathered_[root];
    root = parent_[root];
  }
  while (parent_[v] != root && v != root) {
    const auto i = static_cast<std::size_t>(v);
    const std::int32_t next = parent_[i];
    const double own = gathered_[i];
    gathered_[i] = offset;
    offset -= own;
    parent_[i] = root;
    v = next;
  }
  return root;
}

void Tfce::join(std::int32_t a, std::int32_t b, double integral) {
  if (a == b) return;
  if (extent_[a] < extent_[b]) std::swap(a, b);
  gather(a, integral);
  gather(b, integral);
  const auto under = static_cast<std::size_t>(b), root = static_cast<std::size_t>(a);
  parent_[under] = a;
  gathered_[under] -= gathered_[root];
  extent_[root] += extent_[under];
}

}  // namespace explica::statistics
