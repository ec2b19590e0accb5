// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PlacePlot.h"

#include "Explica/Core/Html.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Provenance/Json.h"

#include <algorithm>
#include <cmath>

namespace explica::app {
namespace {

using provenance::Json;

constexpr double kCharacters = 2.5e6;        // of a page, for values: one each
constexpr Eigen::Index kMostPlaces = 10242;  // of a hemisphere
// Digits of values: what a script element and JSON take as it is.  A value that is not known has
// a space.
constexpr std::string_view kDigits =
    "#$%&'()*+,-./0123456789:;=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[]^_`abcdefghijklmnopqrstuvwxyz{|}~";

/// The person's report, relative to the page's folder; empty if it is not known.
std::string reportOf(const Observations& o, std::size_t person) {
  const auto column = o.about.find("report");
  if (!column || statistics::isMissing(o.about.rows[person][*column])) return {};
  return o.about.rows[person][*column];
}

/// A plot's horizontal axis: the first column of the contrast's terms.
struct Axis {
  std::string name;
  std::vector<double> x;
  std::vector<std::string> levels;  ///< of a categorical column
};

Axis axisOf(const Observations& o, const GlmResults& r, const statistics::Contrast& contrast) {
  const statistics::Factor* factor = nullptr;
  for (std::size_t c = 0; c < r.design.columns.size(); ++c) {
    if (contrast.weights.row(c).isZero()) continue;
    for (const std::string& name : r.design.terms[r.design.termOf[c]]) {
      for (const auto& f : r.design.factors) {
        if (f.name == name && (factor == nullptr || f.levels.empty())) factor = &f;
      }
    }
  }
  Axis axis;
  if (factor == nullptr) {
    axis.name = "people";
    for (std::size_t i = 0; i < o.people.size(); ++i) axis.x.push_back(static_cast<double>(i));
    return axis;
  }
  axis.name = factor->name;
  axis.levels = factor->levels;
  for (const auto& row : o.about.rows) {
    const std::string& cell = row[o.about.at(factor->name)];
    if (factor->levels.empty()) {
      axis.x.push_back(statistics::numberIn(cell).value_or(std::nan("")));
    } else {
      const auto level = std::find(factor->levels.begin(), factor->levels.end(), cell);
      axis.x.push_back(static_cast<double>(level - factor->levels.begin()));
    }
  }
  return axis;
}

/// Vertices of a hemisphere whose values are on the page.  The first vertices of a divided
/// icosahedron are those of a coarser one; of another surface every n-th is taken.
std::vector<Eigen::Index> placesOf(Eigen::Index vertices, Eigen::Index most) {
  std::vector<Eigen::Index> places;
  for (Eigen::Index coarse = 12; coarse <= vertices; coarse = 4 * coarse - 6) {
    if (coarse == vertices) {
      while (coarse > most && coarse > 12) coarse = (coarse + 6) / 4;
      for (Eigen::Index v = 0; v < coarse; ++v) places.push_back(v);
      return places;
    }
  }
  const Eigen::Index apart = std::max<Eigen::Index>(1, (vertices + most - 1) / most);
  for (Eigen::Index v = 0; v < vertices; v += apart) places.push_back(v);
  return places;
}

/// For each vertex, which of the places is nearest to it.
std::vector<int> nearestPlaces(const Eigen::Ref<const Positions>& vertices,
                               const std::vector<Eigen::Index>& places) {
  const Positions at = vertices(places, Eigen::all);
  std::vector<int> nearest(static_cast<std::size_t>(vertices.rows()));
  parallelFor(nearest.size(), 64, [&](std::size_t v) {
    Eigen::Index best = 0;
    (at.rowwise() - vertices.row(v)).rowwise().squaredNorm().minCoeff(&best);
    nearest[v] = static_cast<int>(best);
  });
  return nearest;
}

/// Values of one place as digits between their least and largest.
void addPlace(const Eigen::VectorXd& values, Json& low, Json& high, std::string& digits) {
  double least = std::nan(""), most = std::nan("");
  for (const double value : values) {
    least = std::fmin(least, value);
    most = std::fmax(most, value);
  }
  low.push_back(std::isfinite(least) ? std::stod(numberText(least, 6)) : 0);
  high.push_back(std::isfinite(most) ? std::stod(numberText(most, 6)) : 0);
  const auto last = static_cast<double>(kDigits.size() - 1);
  for (const double value : values) {
    if (!std::isfinite(value)) {
      digits += ' ';
      continue;
    }
    const double share = most > least ? (value - least) / (most - least) : 0;
    digits += kDigits[std::lround(share * last)];
  }
}

Json axisJson(const std::string& contrast, const Axis& axis) {
  Json x = Json::array();
  for (const double value : axis.x) {
    x.push_back(std::isfinite(value) ? Json(std::stod(numberText(value, 6))) : Json());
  }
  return {{"contrast", contrast}, {"name", axis.name}, {"levels", axis.levels}, {"x", x}};
}

Json dataOf(const Observations& o, const GlmResults& r, const std::vector<NamedPlace>& named) {
  const double share =
      kCharacters /
      static_cast<double>(o.people.size() * std::max<std::size_t>(1, o.hemispheres.size()));
  const auto most = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(share), 12, kMostPlaces);
  Json data = {{"people", o.people}, {"digits", std::string(kDigits)}};
  Json low = Json::array(), high = Json::array(), views = Json::object(), reports = Json::array();
  std::string digits;
  int first = 0;
  for (const MapSide& side : o.hemispheres) {
    if (!o.surface) break;  // nothing to click
    const auto places = placesOf(side.count, most);
    const auto vertices = o.surface->mesh.positions.middleRows(side.first, side.count);
    views[side.structure] = {{"first", first}, {"place", nearestPlaces(vertices, places)}};
    first += static_cast<int>(places.size());
    for (const Eigen::Index v : places) addPlace(r.values.col(side.first + v), low, high, digits);
  }
  data["named"] = Json::array();
  for (const NamedPlace& one : named) {
    data["named"].push_back(
        {{"title", nameOfPlace(o, one.place)}, {"contrast", one.contrast}, {"place", low.size()}});
    addPlace(r.values.col(one.place), low, high, digits);
  }
  for (std::size_t i = 0; i < o.people.size(); ++i) reports.push_back(reportOf(o, i));
  data.update(Json{
      {"reports", reports}, {"views", views}, {"low", low}, {"high", high}, {"values", digits}});
  data["axes"] = Json::array();
  for (const auto& contrast : r.contrasts) {
    data["axes"].push_back(axisJson(contrast.name, axisOf(o, r, contrast)));
  }
  return data;
}

constexpr const char* kSection =
    R"html(<section id="place"><h3>People at a place</h3><p class="quiet">Each person's value at a place, to a hundredth of their range, over the contrast's covariate: of a peak or region, or where the surface above is clicked. A point leads to the person's report.</p>
<label>Place <select id="place-name"></select></label> <label>Contrast <select id="place-axis"></select></label><div id="place-plot" aria-live="polite" style="max-width:640px"></div></section>
<script type="application/json" id="place-data">)html";

constexpr const char* kScript = R"js(</script>
<script>
(function () {
  'use strict';
  const data = JSON.parse(document.getElementById('place-data').textContent);
  const box = document.getElementById('place-plot'), choice = document.getElementById('place-axis');
  const names = document.getElementById('place-name');
  data.axes.forEach((axis, n) => choice.add(new Option(axis.contrast, String(n))));
  data.named.forEach((one, n) => names.add(new Option(data.axes[one.contrast].contrast + ': ' + one.title, String(n))));
  const digits = new Map([...data.digits].map((c, n) => [c, n])), last = data.digits.length - 1;
  const make = (name, attributes, parent) => {
    const element = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    parent.append(element);
    return element;
  };
  const readable = (x) => String(Number(x.toPrecision(4)));
  let place = -1, title = '';
  function draw() {
    if (place < 0) return;
    const axis = data.axes[Number(choice.value)], n = data.people.length;
    const low = data.low[place], high = data.high[place];
    const known = axis.x.filter((x) => x !== null), levels = axis.levels.length > 0;
    const margin = levels ? 0.5 : 0.03 * (Math.max(...known) - Math.min(...known) || 1);
    const x0 = Math.min(...known) - margin, x1 = Math.max(...known) + margin;
    const px = (x) => 60 + 350 * (x - x0) / (x1 - x0), py = (y) => 220 - 190 * (y - low) / (high - low || 1);
    box.textContent = '';
    const svg = make('svg', { viewBox: '0 0 420 260', role: 'img', 'aria-label': title, 'font-size': 12 }, box);
    const text = (x, y, words, anchor) => { make('text', { x, y, 'text-anchor': anchor }, svg).textContent = words; };
    text(10, 16, title, 'start');
    make('path', { d: 'M56 26V224H412', fill: 'none', stroke: '#888' }, svg);
    text(52, py(low) + 4, readable(low), 'end');
    text(52, py(high) + 4, readable(high), 'end');
    if (levels) axis.levels.forEach((level, l) => text(px(l), 238, level, 'middle'));
    else { text(px(x0 + margin), 238, readable(x0 + margin), 'middle'); text(px(x1 - margin), 238, readable(x1 - margin), 'middle'); }
    text(236, 254, axis.name, 'middle');
    for (let i = 0; i < n; ++i) {
      const digit = digits.get(data.values[place * n + i]);
      if (digit === undefined || axis.x[i] === null) continue;
      const value = low + (high - low) * digit / last, aside = levels ? (i * 37 % 61 / 61 - 0.5) * 0.5 : 0;
      let parent = svg;
      if (data.reports[i]) parent = make('a', { href: data.reports[i] }, svg);
      const dot = make('circle', { cx: px(axis.x[i] + aside).toFixed(1), cy: py(value).toFixed(1), r: n > 1000 ? 1.6 : 3, fill: '#145ab4', 'fill-opacity': 0.6 }, parent);
      make('title', {}, dot).textContent = data.people[i] + ': ' + readable(value);
    }
  }
  function drawNamed() {
    const one = data.named[Number(names.value)];
    if (!one) return;
    place = one.place;
    title = one.title;
    choice.value = String(one.contrast);
    draw();
  }
  choice.addEventListener('change', draw);
  names.addEventListener('change', drawNamed);
  drawNamed();
  document.addEventListener('place', (event) => {
    const view = data.views[event.detail.view];
    if (!view) return;
    place = view.first + view.place[event.detail.vertex];
    title = event.detail.view + ', near vertex ' + event.detail.vertex;
    names.value = '';
    draw();
  });
})();
</script>
)js";

}  // namespace

std::string placePlot(const Observations& o, const GlmResults& r,
                      const std::vector<NamedPlace>& named) {
  return kSection + scriptSafe(provenance::textOf(dataOf(o, r, named))) + kScript;
}

}  // namespace explica::app
