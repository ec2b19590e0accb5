// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Looks.h"

#include "Explica/Core/Errors.h"

#include <algorithm>

namespace explica::inflation {
namespace {

/// The iteration, with its fraction, at which the visibility first has a value; linear between
/// looks.
double timeOf(const std::vector<Look>& looks, double visibility) {
  for (std::size_t n = 1; n < looks.size(); ++n) {
    const double from = looks[n - 1].visibility, to = looks[n].visibility;
    if (to < visibility || !(to > from)) continue;
    const double share = std::clamp((visibility - from) / (to - from), 0.0, 1.0);
    return looks[n - 1].iteration + share * (looks[n].iteration - looks[n - 1].iteration);
  }
  return looks.back().iteration;
}

}  // namespace

std::vector<double> notesOf(const std::vector<Look>& looks) {
  std::vector<double> notes;
  for (const Look& look : looks) {
    notes.insert(notes.end(), {static_cast<double>(look.iteration), look.visibility, look.seen});
  }
  return notes;
}

std::vector<Look> looksFrom(const std::vector<double>& notes) {
  if (notes.empty() || notes.size() % 3 != 0) {
    throw InvalidInput("state: it is not that of an inflation");
  }
  std::vector<Look> looks;
  for (std::size_t n = 0; n < notes.size(); n += 3) {
    looks.push_back({static_cast<int>(notes[n]), notes[n + 1], notes[n + 2]});
  }
  return looks;
}

std::vector<InflateRecord> withLooks(const std::vector<unfolding::IterationRecord>& steps,
                                     const std::vector<Look>& looks) {
  std::vector<InflateRecord> history;
  auto next = looks.begin();
  Look last;
  for (const unfolding::IterationRecord& step : steps) {
    while (next != looks.end() && next->iteration <= step.iteration) last = *next++;
    history.push_back({step, last.visibility, last.seen});
  }
  return history;
}

std::vector<InflateFrame> framesAlong(const std::vector<Positions>& path,
                                      const std::vector<Look>& looks, int count) {
  std::vector<InflateFrame> frames;
  if (count <= 0 || path.empty()) return frames;
  const double first = looks.front().visibility, last = looks.back().visibility;
  for (int k = 0; k < count; ++k) {
    const bool end = k + 1 == count;
    const double wanted = end ? last : first + (last - first) * k / (count - 1);
    const double time = end ? static_cast<double>(path.size() - 1) : timeOf(looks, wanted);
    const auto n = std::min(static_cast<std::size_t>(time), path.size() - 1);
    const double share = time - static_cast<double>(n);
    InflateFrame frame{wanted, path[n]};
    if (share > 0 && n + 1 < path.size()) frame.positions += share * (path[n + 1] - path[n]);
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace explica::inflation
