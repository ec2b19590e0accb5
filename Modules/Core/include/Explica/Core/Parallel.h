// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace explica {

/// Limits every later parallel loop of this process; 0 means all processors that it may run on.
void setThreadCount(int count);
[[nodiscard]] int threadCount();

/// Calls body(begin, end) for consecutive blocks of [0, count), at most `grain` long, in any order
/// and on several threads.  Block borders depend on `count` and `grain` only.  Each block begins
/// with a checkpoint of the caller's StopScope.  An exception in a body reaches the caller.
void parallelForBlocks(std::size_t count, std::size_t grain,
                       const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body(i) for each i in [0, count), on several threads.
template <class Body>
void parallelFor(std::size_t count, std::size_t grain, const Body& body) {
  parallelForBlocks(count, grain, [&body](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// The same by blocks for bodies of a nanosecond to a microsecond.
template <class Body>
void parallelFor(std::size_t count, const Body& body) {
  parallelFor(count, 1024, body);
}

/// Calls body(i) for each i in [0, count), each of which has parallel loops of its own: as many
/// side by side as there are threads.  A thread that waits within a body begins no other one.
void parallelTasks(std::size_t count, const std::function<void(std::size_t)>& body);

/// Sums map(begin, end) over blocks; partial sums are added in block order, so the result does not
/// depend on the number of threads.  T needs operator+= .
template <class T, class Map>
[[nodiscard]] T parallelSum(std::size_t count, std::size_t grain, T zero, const Map& map) {
  if (count == 0) return zero;
  if (grain == 0) grain = 1;
  std::vector<T> partial((count + grain - 1) / grain, zero);
  parallelForBlocks(count, grain, [&](std::size_t begin, std::size_t end) {
    partial[begin / grain] = map(begin, end);
  });
  T sum = zero;
  for (const T& p : partial) sum += p;
  return sum;
}

}  // namespace explica
