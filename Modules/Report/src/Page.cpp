// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Page.h"

#include "Encoding.h"
#include "Explica/Core/Html.h"
#include "Explica/Core/Text.h"
#include "Explica/Report/Canvas.h"
#include "Explica/Report/Chart.h"
#include "PageParts.h"

#include <algorithm>
#include <array>
#include <set>

namespace explica::report {
namespace {

struct Word {
  const char* className;
  const char* text;
};

Word wordFor(StepState state) {
  constexpr std::array kWords = {Word{"good", "done"}, Word{"notice", "stopped early"},
                                 Word{"notice", "interrupted"}, Word{"bad", "failed"},
                                 Word{"missing", "not run"}};
  return kWords[static_cast<std::size_t>(state)];
}

Word wordFor(FlagLevel level) {
  constexpr std::array kWords = {Word{"good", "right"}, Word{"missing", "remark"},
                                 Word{"notice", "look"}, Word{"bad", "wrong"}};
  return kWords[static_cast<std::size_t>(level)];
}

std::string badge(const Word& word) {
  return std::string("<span class='badge ") + word.className + "'>" + word.text + "</span>";
}

std::string table(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string html = "<table class='numbers'>";
  for (const auto& [name, value] : rows) {
    html +=
        "<tr><th scope='row'>" + escapeHtml(name) + "</th><td>" + escapeHtml(value) + "</td></tr>";
  }
  return html + "</table>";
}

std::string stepHtml(const ReportStep& step) {
  std::string html = "<details class='step'><summary>" + badge(wordFor(step.state)) + " <b>" +
                     escapeHtml(step.name) + "</b>";
  if (step.state != StepState::Missing)
    html += printed(" <span class='quiet'>%.1f s</span>", step.seconds);
  if (!step.message.empty())
    html += " <span class='message'>" + escapeHtml(step.message) + "</span>";
  html += "</summary>";
  if (!step.commandLine.empty())
    html += "<pre tabindex='0' role='region' aria-label='Command of " + escapeHtml(step.name) +
            "'>" + escapeHtml(step.commandLine) + "</pre>";
  for (const std::string& warning : step.warnings)
    html += "<p class='message'>" + escapeHtml(warning) + "</p>";
  html += "<div class='columns'>";
  if (!step.numbers.empty())
    html += "<section><h3>Results</h3>" + table(step.numbers) + "</section>";
  if (!step.options.empty()) {
    html += "<section><h3>Options</h3>" + table(step.options) + "</section>";
  }
  html += "</div>";
  if (!step.version.empty()) html += "<p class='quiet'>" + escapeHtml(step.version) + "</p>";
  return html + "</details>";
}

/// All steps in one fold, which is open where one of them is not done.
std::string stepsHtml(const std::vector<ReportStep>& steps) {
  const bool isDone =
      std::ranges::all_of(steps, [](const auto& step) { return step.state == StepState::Done; });
  std::string html = std::string("<section id='made'><h2>How it was made</h2><details") +
                     (isDone ? "" : " open") + "><summary>Steps: " + std::to_string(steps.size()) +
                     "</summary>";
  for (const ReportStep& step : steps) html += stepHtml(step);
  return html + "</details></section>";
}

// What the script of the three-dimensional view fills.
constexpr const char* kViewHtml = R"(<section id="view3d"><h3>In three dimensions</h3>
<div id="stage"><canvas id="canvas" tabindex="0" aria-label="Surface in three dimensions. Arrow keys rotate, plus and minus zoom, space plays, comma and full stop step, B switches between first and last frame, square brackets change the shape, R shows the patch, W the whole."></canvas><p id="stage-message">Preparing the surface ...</p><p id="under-pointer" aria-live="polite"></p><div id="bar" aria-hidden="true"><span id="bar-title"></span><span id="bar-high"></span><canvas id="bar-colours" width="14" height="128"></canvas><span id="bar-low"></span></div></div>
<div id="controls"><label id="which-label">Surface <select id="which"></select></label>
<label class="of-shapes">Shape <input id="shape" type="range" min="0" max="0" value="0" step="0.02" aria-label="Shape"> <output id="shape-title"></output></label>
<label>Map <select id="map"></select></label>
<label class="of-sides">Show <select id="sides"></select></label>
<label class="of-views">from <select id="from"><option>above</option><option>left</option><option>right</option><option>front</option><option>back</option><option>below</option></select></label>
<button id="whole" type="button">Whole surface</button>
<button id="reset" type="button">To the patch</button>
<label class="of-part"><input id="alone" type="checkbox"> patch alone</label>
<span class="of-frames"><button id="play" type="button" aria-label="Play or pause">&#9654;</button>
<input id="frame" type="range" min="0" max="0" value="0" step="1" aria-label="Frame">
<button id="before-after" type="button">Before / after</button></span>
<output id="frame-title"></output></div>
<p class="quiet">Drag to rotate, wheel or two fingers to zoom, right drag to move; region and value under the pointer are shown, a click moves the slices there. Keys: arrows rotate, + and - zoom, W the whole, R the view of the patch<span class="of-shapes">, [ and ] the shape before and after</span><span class="of-frames">, space plays, comma and full stop step, B before/after</span>.<span class="of-part"> The dark line is the rim of the patch.</span><span class="of-views"> The flat shape is the sphere in an equal-area projection about its lateral side.</span></p></section>
)";

// What the script of the slices fills.
constexpr const char* kSlicesHtml =
    R"(<div id="cut-controls"><label>Place <select id="cut-places"></select></label>
<button id="cut-back" type="button">Previous</button><button id="cut-next" type="button">Next</button>
<button type="button" data-rating="right">1 Right</button><button type="button" data-rating="unsure">2 Unsure</button><button type="button" data-rating="wrong">3 Wrong</button>
<button id="cut-save" type="button">Save rating</button><output id="cut-state"></output>
<label><input id="cut-outlines" type="checkbox" checked> outlines</label>
<label>black at <input id="cut-dark" type="range" min="0" max="254" value="0"></label>
<label>white at <input id="cut-bright" type="range" min="1" max="255" value="255"></label>
<output id="cut-at"></output></div>
<div id="cuts"><canvas id="cut-0" tabindex="0" role="img" aria-label="Axial slice"></canvas><canvas id="cut-1" tabindex="0" role="img" aria-label="Coronal slice"></canvas><canvas id="cut-2" tabindex="0" role="img" aria-label="Sagittal slice"></canvas></div>
<p class="quiet">Click: the other slices and the surface in three dimensions go there, and a click on the surface leads here. Wheel or Page up and down: next slice; Ctrl and wheel, + and -: zoom; Shift and drag: move; double click: all. Keys: arrows move, O outlines, N and P next and previous place, 1 right, 2 unsure, 3 wrong, S saves the rating.</p>
)";

std::string imageHtml(const Picture& picture, const std::string& words) {
  return "<img alt='" + escapeHtml(words) + "' width='" + std::to_string(picture.width) +
         "' height='" + std::to_string(picture.height) + "' src='data:image/png;base64," +
         base64(encodePng(picture)) + "'>";
}

/// A figure under its title, which folds it away.
std::string figureHtml(const std::string& id, const std::string& title, const std::string& caption,
                       bool isOpen, const std::string& body) {
  return "<figure" + (id.empty() ? "" : " id='" + escapeHtml(id) + "'") + "><details" +
         (isOpen ? " open" : "") + "><summary><b>" + escapeHtml(title) + ".</b></summary>" +
         (caption.empty() ? "" : "<p class='quiet'>" + escapeHtml(caption) + "</p>") + body +
         "</details></figure>\n";
}

std::string flagHtml(const ReportFlag& flag) {
  return "<li>" + badge(wordFor(flag.level)) + " <b>" + escapeHtml(flag.what) + "</b> " +
         escapeHtml(flag.why) +
         (flag.see.empty() ? "" : " <a href='#" + escapeHtml(flag.see) + "'>see</a>") + "</li>";
}

/// The worst flag decides; the three worst are the reasons, the others are folded away.
std::string verdictHtml(std::vector<ReportFlag> flags) {
  constexpr std::size_t kReasons = 3;
  if (flags.empty()) return "<p class='verdict'>Nothing was found that could be judged.</p>";
  std::ranges::stable_sort(flags, [](const auto& a, const auto& b) { return a.level > b.level; });
  const FlagLevel worst = std::max(flags.front().level, FlagLevel::Good);
  const Word word = worst == FlagLevel::Bad      ? Word{"bad", "Do not use it as it is"}
                    : worst == FlagLevel::Notice ? Word{"notice", "Look at it before you use it"}
                                                 : Word{"good", "Right"};
  const auto grave = std::ranges::count_if(
      flags, [](const ReportFlag& flag) { return flag.level >= FlagLevel::Notice; });
  const auto good = std::ranges::count_if(
      flags, [](const ReportFlag& flag) { return flag.level == FlagLevel::Good; });
  std::string reasons, others;
  for (std::size_t n = 0; n < flags.size(); ++n) {
    const bool isReason = n < kReasons && flags[n].level >= FlagLevel::Notice;
    (isReason ? reasons : others) += flagHtml(flags[n]);
  }
  std::string html = std::string("<p class='verdict ") + word.className + "'><b>" + word.text +
                     ".</b> " + std::to_string(good) + " of " + std::to_string(good + grave) +
                     " checks passed.</p>";
  if (!reasons.empty()) html += "<ul class='flags'>" + reasons + "</ul>";
  if (!others.empty()) {
    html += "<details><summary>" + std::string(reasons.empty() ? "All" : "All other") +
            " checks and remarks</summary><ul class='flags'>" + others + "</ul></details>";
  }
  return html;
}

std::string glanceHtml(const ReportGlance& glance);

std::string drawingHtml(const ReportDrawing& drawing) {
  const std::string title = escapeHtml(drawing.title);
  const bool isSplit = drawing.panels > 1;
  std::string html = "<div class='wide" + std::string(isSplit ? " panels" : "") +
                     "' tabindex='0' role='region' aria-label='" + title + "'>";
  for (int p = 0; p < drawing.panels; ++p) {
    html += "<img alt='" + title + "' class='drawing' " +
            (isSplit ? "style='object-position: " + std::to_string(100 * p / (drawing.panels - 1)) +
                           "%' "
                     : "") +
            "src='data:" + drawing.mediaType + ";base64," + base64(drawing.bytes) + "'>";
  }
  return html + "</div>";
}

/// The pictures in the head of the page; empty if there are none.
std::string picturesAtGlance(const ReportContent& content) {
  std::string html;
  for (const ReportGlance& glance : content.glance) html += glanceHtml(glance);
  for (const ReportDrawing& drawing : content.drawings) {
    if (drawing.guide.empty()) continue;
    html += std::string("<div class='seen") + (drawing.panels > 1 ? " broad" : "") + "'><h3>" +
            escapeHtml(drawing.title) + "</h3>" + drawingHtml(drawing) + "<p class='quiet'>" +
            escapeHtml(drawing.guide) + "</p></div>";
  }
  return html;
}

/// What a reader decides by.
std::string headHtml(const ReportContent& content) {
  std::string words = "<div>" + verdictHtml(content.flags);
  if (!content.facts.empty()) words += table(content.facts);
  words += "</div>";
  const std::string pictures = picturesAtGlance(content);
  if (!pictures.empty()) {
    words = "<div class='head'>" + words + "<div class='glance'>" + pictures + "</div></div>";
  }
  return "<section id='verdict'><h2>Is it right?</h2>" + words + "</section>\n";
}

std::string findingsHtml(const ReportFindings& findings) {
  if (findings.rows.empty()) return {};
  std::string html =
      "<section id='numbers'><h2>What was found</h2><div class='wide' tabindex='0' role='region' "
      "aria-label='What was found'><table class='findings'>";
  const bool isExpected =
      std::ranges::any_of(findings.rows, [](const auto& row) { return !row.expected.empty(); });
  if (findings.columns.size() > 1 || isExpected) {
    html += "<thead><tr><td></td>";
    for (const std::string& column : findings.columns) {
      html += "<th scope='col'>" + escapeHtml(column.empty() ? "found" : column) + "</th>";
    }
    if (isExpected) html += "<th scope='col'>expected</th>";
    html += "<td></td></tr></thead>";
  }
  html += "<tbody>";
  std::string group;
  for (const ReportFindings::Row& row : findings.rows) {
    if (row.group != group) {
      group = row.group;
      html += printed("<tr class='group'><th scope='colgroup' colspan='%zu'>",
                      findings.columns.size() + (isExpected ? 3 : 2)) +
              escapeHtml(group) + "</th></tr>";
    }
    html += "<tr><th scope='row'>" + escapeHtml(row.what);
    if (!row.unit.empty()) html += " <span class='quiet'>" + escapeHtml(row.unit) + "</span>";
    html += "</th>";
    const std::size_t span = findings.columns.size() / std::max<std::size_t>(1, row.values.size());
    for (const std::string& value : row.values) {
      html += printed("<td colspan='%zu'>", span) + escapeHtml(value) + "</td>";
    }
    if (isExpected) html += "<td class='expected'>" + escapeHtml(row.expected) + "</td>";
    html += "<td class='meaning'>" + escapeHtml(row.meaning) + "</td></tr>";
  }
  return html + "</tbody></table></div></section>\n";
}

/// Round values along the bar, as text.
std::string barHtml(const ColourScale& scale) {
  constexpr int kStops = 16;  // of a scale's gradient
  std::string gradient;
  for (int s = 0; s <= kStops; ++s) {
    gradient += (s == 0 ? "" : ",") + hexText(colourAt(scale.map, static_cast<double>(s) / kStops));
  }
  std::string html = "<div class='scale'><span class='scale-title'>" + escapeHtml(barTitle(scale)) +
                     "</span><div class='scale-bar' style='background:linear-gradient(to right," +
                     gradient + ")'></div><div class='scale-ticks'>";
  const double range = scale.high - scale.low;
  for (const double value : roundTicks(scale.low, scale.high)) {
    html += printed("<span style='left:%.1f%%'>", 100 * (value - scale.low) / range) +
            tickText(value, range) + "</span>";
  }
  return html + "</div></div>";
}

std::string legendHtml(const std::vector<LegendEntry>& legend) {
  constexpr std::size_t kFew = 12;
  std::string html = legend.size() > kFew ? "<details><summary>" + std::to_string(legend.size()) +
                                                " names and colours</summary>"
                                          : "";
  html += "<ul class='legend'>";
  for (const LegendEntry& entry : legend) {
    html += "<li><span class='swatch' style='background:" + hexText(entry.colour) + "'></span>" +
            escapeHtml(entry.name) + "</li>";
  }
  return html + "</ul>" + (legend.size() > kFew ? "</details>" : "");
}

std::string viewHtml(const std::string& name, const Picture& picture, const std::string& words) {
  return "<div class='view'>" + imageHtml(picture, words) + "<span>" + escapeHtml(name) +
         "</span></div>";
}

std::string viewsHtml(const ReportViews& views, bool isOpen) {
  std::string html = "<div class='views'>";
  for (const ReportViews::View& view : views.views) {
    html += viewHtml(view.title, view.picture, views.title + ", " + view.title);
  }
  html += "</div>";
  if (views.scale) html += barHtml(*views.scale);
  if (!views.legend.empty()) html += legendHtml(views.legend);
  return figureHtml(views.id, views.title, views.caption, isOpen, html);
}

using Outlines = std::vector<std::pair<std::string, std::string>>;

/// @param after  the same slice of the other image, or nullptr
std::string tileHtml(const MosaicTile& tile, const Outlines& outlines, const MosaicTile* after) {
  std::string html = "<div class='tile'>" + imageHtml(tile.picture, "slice at " + tile.place);
  if (after) {
    html += "<div class='other'>" +
            imageHtml(after->picture, "slice at " + tile.place + ", after") + "</div>";
  }
  html += "<svg viewBox='0 0 " + std::to_string(tile.picture.width) + " " +
          std::to_string(tile.picture.height) + "' aria-hidden='true'>";
  for (std::size_t n = 0; n < tile.paths.size(); ++n) {
    html += "<path stroke='" + outlines[n].second + "' d='" + tile.paths[n] + "'/>";
  }
  html += "</svg>";
  constexpr std::array kSides = {"left", "right", "top", "bottom"};
  for (std::size_t s = 0; s < kSides.size(); ++s) {
    html += std::string("<span class='letter ") + kSides[s] + "'>" + tile.letters[s] + "</span>";
  }
  return html + "<span class='place'>" + escapeHtml(tile.place) + "</span></div>";
}

/// Each outline's name beside its colour; both hemispheres' outlines have one name.
std::string keyHtml(const Outlines& outlines) {
  std::string html;
  std::set<std::string> named;
  for (const auto& [name, colour] : outlines) {
    if (!named.insert(name).second) continue;
    html += "<span class='swatch' style='background:" + colour + "'></span>" + escapeHtml(name) +
            " &nbsp; ";
  }
  return html;
}

std::string mosaicHtml(const ReportMosaic& mosaic, bool isOpen) {
  std::string html = "<p class='quiet'>" + keyHtml(mosaic.slices.outlines);
  if (!mosaic.slices.outlines.empty()) {
    html += "<label><input type='checkbox' class='outlines' checked> outlines</label> &nbsp; ";
  }
  if (mosaic.after) {
    html += "<span class='states'><label><input type='checkbox' class='to-other'> " +
            escapeHtml(mosaic.states[1]) + " instead of " + escapeHtml(mosaic.states[0]) +
            "</label> <button type='button' class='flicker' "
            "aria-pressed='false'>Flicker</button></span> &nbsp; ";
  }
  html += mosaic.slices.convention == SideConvention::Neurological
              ? "Neurological convention: the person's left is on the left."
              : "Radiological convention: the person's left is on the right.";
  html += "</p>";
  for (std::size_t r = 0; r < mosaic.slices.rows.size(); ++r) {
    const auto& row = mosaic.slices.rows[r];
    html += "<div class='tiles' style='--tiles:" + std::to_string(row.size()) + "'>";
    for (std::size_t n = 0; n < row.size(); ++n) {
      html += tileHtml(row[n], mosaic.slices.outlines,
                       mosaic.after ? &mosaic.after->rows[r][n] : nullptr);
    }
    html += "</div>";
  }
  return figureHtml(mosaic.id, mosaic.title, mosaic.caption, isOpen, html);
}

std::string glanceHtml(const ReportGlance& glance) {
  std::string html = "<div class='seen'><h3>";
  html += glance.see.empty()
              ? escapeHtml(glance.title)
              : "<a href='#" + escapeHtml(glance.see) + "'>" + escapeHtml(glance.title) + "</a>";
  html += "</h3><div class='beside'>";
  for (const MosaicTile& tile : glance.tiles) html += tileHtml(tile, glance.outlines, nullptr);
  for (const auto& [name, picture] : glance.views) {
    html += viewHtml(name, picture, glance.title + ", " + name);
  }
  html += "</div>";
  if (glance.scale) html += barHtml(*glance.scale);
  if (!glance.outlines.empty()) html += "<p class='quiet'>" + keyHtml(glance.outlines) + "</p>";
  return html + "<p class='quiet'>" + escapeHtml(glance.guide) + "</p></div>";
}

using Charts = std::vector<const ReportChart*>;

std::string chartGridHtml(const Charts& charts) {
  std::string html = "<div class='charts'>";
  for (const ReportChart* chart : charts) {
    html += "<div" + (chart->id.empty() ? "" : " id='" + escapeHtml(chart->id) + "'") + ">" +
            chart->svg + "</div>\n";
  }
  return html + "</div>";
}

/// The charts of one group under its name, which folds them away.
std::string chartGroupHtml(const Charts& group, bool isOpen) {
  const std::string& name = group.front()->group;
  return name.empty() ? chartGridHtml(group)
                      : figureHtml("", name, "", isOpen, chartGridHtml(group));
}

std::string chartsHtml(const std::vector<ReportChart>& charts) {
  std::string html;
  Charts group;
  for (std::size_t n = 0; n < charts.size(); ++n) {
    group.push_back(&charts[n]);
    if (n + 1 < charts.size() && charts[n + 1].group == charts[n].group) continue;
    html += chartGroupHtml(group, html.empty());
    group.clear();
  }
  return html;
}

std::string tableHtml(const ReportTable& table) {
  std::string html = "<div class='wide' tabindex='0' role='region' aria-label='" +
                     escapeHtml(table.title) + "'><table class='rows'><thead><tr>";
  for (const std::string& column : table.columns) {
    html += "<th scope='col'>" + escapeHtml(column) + "</th>";
  }
  html += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t n = 0; n < row.size(); ++n) {
      html += n == 0 ? "<th scope='row'>" + escapeHtml(row[n]) + "</th>"
                     : "<td>" + escapeHtml(row[n]) + "</td>";
    }
    html += "</tr>";
  }
  return figureHtml(table.id, table.title, table.caption, false, html + "</tbody></table></div>");
}

/// A heading over what follows, and its link in the table of contents.
std::string heading(const std::string& id, const std::string& words) {
  return "<h3 id='" + id + "'>" + words + "</h3>";
}

/// What is seen at the head, or in the slices to scroll through, is folded.
std::string lookHtml(const ReportContent& content) {
  std::string html;
  if (!content.evolutions.empty()) html += kViewHtml;
  if (content.slices || !content.mosaics.empty()) html += heading("slices", "Slices");
  if (content.slices) {
    html +=
        figureHtml(content.slices->id, content.slices->title, content.slices->caption, true,
                   "<p class='quiet'>" + keyHtml(content.slices->outlines) + "</p>" + kSlicesHtml);
  }
  for (const ReportMosaic& mosaic : content.mosaics) {
    html += mosaicHtml(mosaic, !content.slices && !mosaic.after);
  }
  if (!content.views.empty()) html += heading("surfaces", "Surfaces");
  for (const ReportViews& views : content.views) {
    html += viewsHtml(views, std::ranges::find(content.glance, views.id, &ReportGlance::see) ==
                                 content.glance.end());
  }
  const bool isDrawnAtHead =
      std::ranges::any_of(content.drawings, [](const auto& drawn) { return !drawn.guide.empty(); });
  std::string pictures;
  for (const ReportDrawing& drawing : content.drawings) {
    if (!drawing.guide.empty()) continue;
    pictures += figureHtml(drawing.id, drawing.title, drawing.caption, !isDrawnAtHead,
                           drawingHtml(drawing));
  }
  if (!pictures.empty()) html += heading("pictures", "Pictures") + pictures;
  if (!content.charts.empty()) html += heading("charts", "Distributions and curves");
  html += chartsHtml(content.charts);
  return html.empty() ? html
                      : "<section id='look'><h2>See for yourself</h2>" + html + "</section>\n";
}

std::string tablesHtml(const std::vector<ReportTable>& tables) {
  if (tables.empty()) return {};
  std::string html = heading("tables", "Tables");
  for (const ReportTable& table : tables) html += tableHtml(table);
  return html;
}

/// Links to the parts of the page, which stay in sight.
std::string contentsHtml(const std::string& page) {
  constexpr std::array kParts = {
      std::pair{"verdict", "Verdict"},     std::pair{"numbers", "Numbers"},
      std::pair{"tables", "Tables"},       std::pair{"view3d", "3-D"},
      std::pair{"slices", "Slices"},       std::pair{"surfaces", "Surfaces"},
      std::pair{"pictures", "Pictures"},   std::pair{"charts", "Curves"},
      std::pair{"made", "How it was made"}};
  std::string html = "<nav aria-label='Contents'>";
  for (const auto& [id, words] : kParts) {
    const std::string name = id;
    const bool isThere = page.find(" id='" + name + "'") != std::string::npos ||
                         page.find(" id=\"" + name + "\"") != std::string::npos;
    if (isThere) html += "<a href='#" + name + "'>" + words + "</a>";
  }
  return html + "</nav>\n";
}

}  // namespace

std::string reportPage(const ReportContent& content) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><link rel=\"icon\" href=\"data:,\"><title>";
  html +=
      escapeHtml(content.title) + "</title>\n<style>\n" + kPageStyle + "</style></head><body>\n";
  html += "<header><h1>" + escapeHtml(content.title) + "</h1></header>";
  const std::string parts = headHtml(content) + findingsHtml(content.findings) +
                            tablesHtml(content.tables) + lookHtml(content) +
                            stepsHtml(content.steps);
  html += contentsHtml(parts) + "<main>\n" + parts + "</main>\n";
  for (const Evolution& evolution : content.evolutions) {
    html += "<script type=\"application/json\" class=\"evolution\" data-title=\"" +
            escapeHtml(evolution.title) + "\" data-scene=\"" + escapeHtml(evolution.scene) + "\">" +
            scriptSafe(evolutionJson(evolution)) + "</script>\n";
  }
  if (content.slices) {
    html += "<script type=\"application/json\" id=\"slice-data\">" +
            scriptSafe(content.slices->json) + "</script>\n";
  }
  if (!content.evolutions.empty()) {
    html += "<script>\n" + std::string(kThreeScript) + "\n</script>\n";
  }
  html += std::string("<script>\n") + kPageScript + "</script>\n";
  return html + "</body></html>\n";
}

}  // namespace explica::report
