// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/HeartLabels.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"

#include <algorithm>
#include <set>

namespace explica::ventricle {

namespace {

// Shares of a label's outline within the slices that touch the wall: a left cavity's is nearly all
// of it, a right ventricle's at most its septal side.
constexpr double kEnclosed = 0.7, kBeside = 0.55;

const HeartRoles kAcdc = {3, 2, 1, "acdc"};
const HeartRoles kMms = {1, 2, 3, "mms or ukbb"};

std::set<Label> valuesOf(const std::vector<Volume<Label>>& frames) {
  std::set<Label> values;
  for (const Volume<Label>& frame : frames) {
    Label last = 0;
    for (const Label label : frame.data) {
      if (label != last) values.insert(last = label);
    }
  }
  values.erase(0);
  return values;
}

/// The first dozen; an image taken for labels has hundreds.
std::string listOf(const std::set<Label>& values) {
  constexpr std::size_t kShown = 12;  // labels in a message
  std::string text;
  std::size_t shown = 0;
  for (const Label v : values) {
    if (++shown > kShown) break;
    text += (text.empty() ? "" : ", ") + std::to_string(v);
  }
  if (values.size() > kShown) {
    text += " and " + std::to_string(values.size() - kShown) + " more (is this an image?)";
  }
  return text.empty() ? "none but 0" : text;
}

/// Share of a label's outline within the slices that touches the wall, over the frames that have
/// one.
double enclosedShare(const std::vector<Volume<Label>>& frames, Label label, Label wall) {
  std::size_t outline = 0, touching = 0;
  for (const Volume<Label>& frame : frames) {
    if (std::find(frame.data.begin(), frame.data.end(), wall) == frame.data.end()) continue;
    const auto& size = frame.grid.size;
    const auto visit = [&](Label a, Label b) {
      if (a == b || (a != label && b != label)) return;
      ++outline;
      touching += a == wall || b == wall;
    };
    for (int k = 0; k < size[2]; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          if (i + 1 < size[0]) visit(frame(i, j, k), frame(i + 1, j, k));
          if (j + 1 < size[1]) visit(frame(i, j, k), frame(i, j + 1, k));
        }
      }
    }
  }
  return outline == 0 ? 0 : static_cast<double>(touching) / static_cast<double>(outline);
}

HeartRoles automaticRoles(const std::vector<Volume<Label>>& frames, const std::set<Label>& values) {
  const std::string sentence =
      "the labels found are " + listOf(values) +
      "; say which is what with --preset acdc, mms or ukbb, or with --cavity N --wall N [--rv N]";
  if (values.empty() || *values.begin() < 0 || *values.rbegin() > 3) throw InvalidInput(sentence);
  if (values.contains(2)) {
    const double one = enclosedShare(frames, 1, 2), three = enclosedShare(frames, 3, 2);
    if (one >= kEnclosed && three <= kBeside) return kMms;
    if (three >= kEnclosed && one <= kBeside) return kAcdc;
    throw InvalidInput("which label the wall encloses does not tell cavity from right ventricle; " +
                       sentence);
  }
  throw InvalidInput("no frame has a wall: " + sentence);
}

HeartRoles presetRoles(const std::vector<Volume<Label>>& frames, const std::set<Label>& values,
                       Preset preset) {
  switch (preset) {
    case Preset::Acdc:
      return kAcdc;
    case Preset::Mms:
    case Preset::Ukbb: {
      HeartRoles roles = kMms;
      roles.how = std::string(nameOf(preset));
      return roles;
    }
    case Preset::None:
      throw InvalidInput("--preset none: --cavity N and --wall N say which labels these are");
    default:
      return automaticRoles(frames, values);
  }
}

}  // namespace

HeartRoles findRoles(const std::vector<Volume<Label>>& frames, const HeartLabelOptions& options) {
  if (frames.empty()) throw InvalidInput("no frame was given");
  const std::set<Label> values = valuesOf(frames);
  HeartRoles roles;
  if (options.cavity && options.wall) {
    roles = {*options.cavity, *options.wall, options.right, "given"};
  } else {
    roles = presetRoles(frames, values, options.preset);
    if (options.cavity) roles.cavity = *options.cavity;
    if (options.wall) roles.wall = *options.wall;
    if (options.right) roles.right = options.right;
    if (options.cavity || options.wall || options.right) roles.how += ", partly given";
  }
  if (roles.cavity == roles.wall || roles.right == roles.cavity || roles.right == roles.wall) {
    throw InvalidInput("cavity, wall and right ventricle need different labels");
  }
  for (const auto& [what, label] : {std::pair{"cavity", roles.cavity}, {"wall", roles.wall}}) {
    if (!values.contains(label)) {
      throw InvalidInput("no frame has label " + std::to_string(label) + " (the " + what +
                         "); labels found: " + listOf(values));
    }
  }
  if (options.right && !values.contains(*options.right)) {
    throw InvalidInput("no frame has label " + std::to_string(*options.right) +
                       " (the right ventricle); labels found: " + listOf(values));
  }
  if (roles.right && !values.contains(*roles.right)) roles.right.reset();
  return roles;
}

Volume<Label> relabelled(const Volume<Label>& frame, const HeartRoles& roles) {
  Volume<Label> heart(frame.grid, kOutside);
  parallelFor(frame.size(), 1 << 16, [&](std::size_t v) {
    const Label label = frame[v];
    if (label == roles.cavity) heart[v] = kCavity;
    if (label == roles.wall) heart[v] = kWall;
    if (roles.right && label == *roles.right) heart[v] = kRight;
  });
  return heart;
}

std::int64_t takeOutIslands(Volume<Label>& heart) {
  if (std::ranges::find(heart.data, kWall) == heart.data.end()) return 0;
  const VoxelSet left =
      setWhere(heart.grid, [&](std::size_t v) { return heart[v] == kCavity || heart[v] == kWall; });
  const Components pieces = componentsOf(left);
  std::vector<bool> hasCavity(pieces.size.size()), hasWall(pieces.size.size());
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (left[v]) (heart[v] == kWall ? hasWall : hasCavity)[pieces.number[v]] = true;
  }
  std::int64_t taken = 0;
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (!left[v] || (hasCavity[pieces.number[v]] && hasWall[pieces.number[v]])) continue;
    heart[v] = kOutside;
    ++taken;
  }
  return taken;
}

}  // namespace explica::ventricle
