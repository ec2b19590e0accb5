// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusAssembly.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Runs.h"
#include "Explica/Harmonic/LabelBoundary.h"

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

namespace explica::harmonic {
namespace {

// Room around the tissue within which boundaries are made from labels.
constexpr int kLabelMargin = 4;

std::string listed(const std::vector<Label>& labels) {
  std::ostringstream text;
  for (std::size_t k = 0; k < labels.size(); ++k) text << (k ? ", " : "") << labels[k];
  return text.str();
}

/// What each label is to the tissue; labels are few, so a list of pairs serves.
class RoleTable {
 public:
  explicit RoleTable(const LabelRoles& roles)
      // If the outer labels are named, the rest belongs to neither side.
      : rest_(codeOf(roles.outer.empty() ? Site::Outer : Site::Insulated)) {
    if (roles.tissue.empty()) throw InvalidInput("no tissue label was given (--tissue)");
    if (roles.inner.empty()) throw InvalidInput("no inner label was given (--inner)");
    assign(roles.inner, Site::Inner);
    assign(roles.tissue, Site::Tissue);
    assign(roles.insulated, Site::Insulated);
    assign(roles.outer, Site::Outer);
  }

  [[nodiscard]] Code roleOf(Label value) const {
    for (const auto& [other, code] : table_) {
      if (other == value) return code;
    }
    return rest_;
  }

  /// @throws InvalidInput  a role none of whose labels is among those present
  void requirePresent(const std::set<Label>& present, const Monitor& monitor) const {
    std::vector<Label> missing;
    std::set<Code> filled;
    for (const auto& [value, code] : table_) {
      if (present.contains(value)) {
        filled.insert(code);
      } else {
        missing.push_back(value);
      }
    }
    if (missing.empty()) return;
    const std::string absent = "label " + listed(missing) + " is absent";
    if (std::all_of(table_.begin(), table_.end(),
                    [&](const auto& entry) { return filled.contains(entry.second); })) {
      monitor.warn(absent + "; the other labels of its list are used");
      return;
    }
    constexpr std::size_t kMostListed = 40;
    std::vector<Label> found(present.begin(), present.end());
    const bool many = found.size() > kMostListed;
    if (many) found.resize(kMostListed);
    throw InvalidInput(absent + "; the file has " + listed(found) + (many ? ", ..." : ""));
  }

 private:
  void assign(const std::vector<Label>& values, Site site) {
    for (const Label value : values) {
      for (const auto& [other, code] : table_) {
        if (other == value && code != codeOf(site)) {
          throw InvalidInput("label " + std::to_string(value) +
                             " is given two roles; each label has one");
        }
      }
      table_.emplace_back(value, codeOf(site));
    }
  }

  Code rest_;
  std::vector<std::pair<Label, Code>> table_;
};

std::set<Label> labelsIn(const Volume<Label>& labels) {
  const Grid& grid = labels.grid;
  const std::size_t sliceSize = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  std::vector<std::set<Label>> bySlice(grid.size[2]);
  parallelFor(grid.size[2], 1, [&](std::size_t k) {
    const std::size_t end = (k + 1) * sliceSize;
    for (std::size_t v = k * sliceSize; v < end; v = runEnd(labels.data.data(), v, end)) {
      bySlice[k].insert(labels[v]);
    }
  });
  std::set<Label> present;
  for (const auto& slice : bySlice) present.insert(slice.begin(), slice.end());
  return present;
}

Box boxAroundTissue(const Volume<Label>& labels, const RoleTable& roles) {
  const Grid& grid = labels.grid;
  return boxAround(grid, kLabelMargin, [&](std::size_t row, int& low, int& high) {
    const Label* line = labels.data.data() + row * grid.size[0];
    const std::size_t length = grid.size[0];
    low = grid.size[0];
    for (std::size_t i = 0, end = 0; i < length; i = end) {
      end = runEnd(line, i, length);
      if (roles.roleOf(line[i]) != kTissueCode) continue;
      low = std::min(low, static_cast<int>(i));
      high = static_cast<int>(end) - 1;
    }
  });
}

/// Roles of the box's voxels; beyond the image they are insulated.
std::vector<Code> sitesIn(const Box& box, const Volume<Label>& labels, const RoleTable& roles) {
  const Grid& grid = labels.grid;
  std::vector<Code> sites(box.count(), codeOf(Site::Insulated));
  parallelFor(box.size[2], 1, [&](std::size_t kk) {
    const int k = static_cast<int>(kk);
    for (int j = 0; j < box.size[1]; ++j) {
      const int gj = j + box.first[1], gk = k + box.first[2];
      if (gj < 0 || gk < 0 || gj >= grid.size[1] || gk >= grid.size[2]) continue;
      const Label* line = labels.data.data() + grid.linear(0, gj, gk);
      Code* to = sites.data() + box.linear(0, j, k);
      const std::size_t first = std::max(box.first[0], 0);
      const std::size_t length = std::min(box.first[0] + box.size[0], grid.size[0]);
      for (std::size_t i = first, end = 0; i < length; i = end) {
        end = runEnd(line, i, length);
        std::fill(to + i - box.first[0], to + end - box.first[0], roles.roleOf(line[i]));
      }
    }
  });
  return sites;
}

/// The inner boundary of sites, or the outer one.
LabelBoundary boundaryOf(const std::vector<Code>& sites, const Box& box, bool outer, int axes) {
  std::vector<std::uint8_t> side(sites.size());
  parallelFor(side.size(), 1 << 16, [&](std::size_t p) {
    const auto site = static_cast<Site>(sites[p]);
    if (site == Site::Insulated) {
      side[p] = 255;
    } else {
      side[p] = site == Site::Inner || (outer && site == Site::Tissue) ? 1 : 0;
    }
  });
  return LabelBoundary(side, box.size, axes);
}

BoxOfSites sitesOf(const Volume<Label>& labels, const LabelRoles& roles, const Monitor& monitor) {
  checkGrid(labels.grid);
  const RoleTable table(roles);
  table.requirePresent(labelsIn(labels), monitor);
  const Box box = boxAroundTissue(labels, table);
  return {labels.grid, box, sitesIn(box, labels, table)};
}

Annulus annulusOf(BoxOfSites found, const AnnulusOptions& options, const Monitor& monitor) {
  const Grid& grid = found.grid;
  const Box& box = found.box;
  std::optional<LabelBoundary> innerBoundary, outerBoundary;
  if (options.boundary != BoundaryModel::Staircase) {
    const int axes = options.perSlice ? 2 : grid.dimension();
    parallelFor(2, 1, [&](std::size_t outer) {
      (outer == 1 ? outerBoundary : innerBoundary)
          .emplace(boundaryOf(found.sites, box, outer == 1, axes));
    });
  }
  const std::array<int, 3> strides = {1, box.size[0], box.size[0] * box.size[1]};
  const auto placeOnLink = [&](std::int32_t p, const std::array<int, 3>&, int d, bool inner) {
    const LabelBoundary& boundary = inner ? *innerBoundary : *outerBoundary;
    const int a = axisOf(d);
    return signOf(d) > 0 ? boundary.place(p, a) : 1 - boundary.place(p - strides[a], a);
  };
  return assemble(grid, box, std::move(found.sites), placeOnLink, options, monitor);
}

}  // namespace

Annulus annulusFromLabels(const Volume<Label>& labels, const LabelRoles& roles,
                          const AnnulusOptions& options, const Monitor& monitor) {
  return annulusOf(sitesOf(labels, roles, monitor), options, monitor);
}

Annulus annulusFromLabels(Volume<Label>&& labels, const LabelRoles& roles,
                          const AnnulusOptions& options, const Monitor& monitor) {
  BoxOfSites found = sitesOf(labels, roles, monitor);
  std::vector<Label>().swap(labels.data);
  return annulusOf(std::move(found), options, monitor);
}

Annulus annulusFromSites(const Volume<Site>& sites, const AnnulusOptions& options,
                         const Monitor& monitor) {
  return annulusOf(boxOf(sites, kLabelMargin), options, monitor);
}

}  // namespace explica::harmonic
