// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Page.h"

#include "Encoding.h"
#include "Explica/Report/Chart.h"
#include "PageParts.h"

#include <array>
#include <cstdio>

namespace explica::report {
namespace {

struct Word {
  const char* className;
  const char* text;
};

Word wordFor(StepState state) {
  switch (state) {
    case StepState::Done:
      return {"good", "done"};
    case StepState::StoppedEarly:
      return {"notice", "stopped early"};
    case StepState::Failed:
      return {"bad", "failed"};
    default:
      return {"missing", "not run"};
  }
}

Word wordFor(FlagLevel level) {
  switch (level) {
    case FlagLevel::Good:
      return {"good", "good"};
    case FlagLevel::Notice:
      return {"notice", "note"};
    default:
      return {"bad", "check"};
  }
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
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.1f s", step.seconds);
  std::string html = "<details class='step'><summary>" + badge(wordFor(step.state)) + " <b>" +
                     escapeHtml(step.name) + "</b>";
  if (step.state != StepState::Missing)
    html += " <span class='quiet'>" + std::string(seconds.data()) + "</span>";
  if (!step.message.empty())
    html += " <span class='message'>" + escapeHtml(step.message) + "</span>";
  html += "</summary>";
  if (!step.commandLine.empty()) html += "<pre>" + escapeHtml(step.commandLine) + "</pre>";
  for (const std::string& warning : step.warnings)
    html += "<p class='message'>" + escapeHtml(warning) + "</p>";
  html += "<div class='columns'>";
  if (!step.numbers.empty())
    html += "<section><h3>Results</h3>" + table(step.numbers) + "</section>";
  if (!step.options.empty())
    html += "<section><h3>Options</h3>" + table(step.options) + "</section>";
  html += "</div>";
  if (!step.version.empty()) html += "<p class='quiet'>" + escapeHtml(step.version) + "</p>";
  return html + "</details>";
}

/// JSON as it may stand in a script element.
std::string scriptSafe(const std::string& json) {
  std::string safe;
  for (const char c : json) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

constexpr const char* kViewHtml = R"(<section id="view3d"><h2>Evolution in three dimensions</h2>
<div id="stage"><canvas id="canvas" tabindex="0" aria-label="Surface in three dimensions. Arrow keys rotate, plus and minus zoom, space plays, comma and full stop step, B switches between first and last frame, R resets."></canvas><p id="stage-message">Preparing the surface ...</p><div id="bar" aria-hidden="true"><canvas id="bar-colours" width="14" height="128"></canvas><span id="bar-high"></span><span id="bar-title"></span><span id="bar-low"></span></div></div>
<div id="controls"><button id="play" type="button" aria-label="Play or pause">&#9654;</button>
<input id="frame" type="range" min="0" max="0" value="0" step="1" aria-label="Frame">
<output id="frame-title"></output>
<label>Map <select id="map"></select></label>
<button id="before-after" type="button">Before / after</button>
<label><input id="alone" type="checkbox"> region alone</label>
<button id="reset" type="button">Reset view</button></div>
<p class="quiet">Drag to rotate, wheel or two fingers to zoom, right drag to move. Keys: arrows rotate, + and - zoom, space plays, comma and full stop step, B before/after, R resets.</p></section>
)";

}  // namespace

std::string reportPage(const ReportContent& content) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<link rel=\"icon\" href=\"data:,\"><title>";
  html +=
      escapeHtml(content.title) + "</title>\n<style>\n" + kPageStyle + "</style></head><body>\n";
  html += "<header><h1>" + escapeHtml(content.title) + "</h1></header><main>\n";

  html += "<section><h2>Is it good?</h2><ul class='flags'>";
  for (const ReportFlag& flag : content.flags) {
    html += "<li>" + badge(wordFor(flag.level)) + " <b>" + escapeHtml(flag.what) + "</b> " +
            escapeHtml(flag.why) + "</li>";
  }
  if (content.flags.empty()) html += "<li>Nothing was found that could be judged.</li>";
  html += "</ul></section>\n";

  if (content.evolution) html += kViewHtml;

  if (!content.pictures.empty()) {
    html += "<section><h2>Pictures</h2>";
    for (const ReportPicture& picture : content.pictures) {
      html += "<figure><img alt='" + escapeHtml(picture.title) + "' src='data:image/png;base64," +
              base64(encodePng(picture.picture)) + "'><figcaption><b>" + escapeHtml(picture.title) +
              ".</b> " + escapeHtml(picture.caption) + "</figcaption></figure>\n";
    }
    html += "</section>\n";
  }
  if (!content.charts.empty()) {
    html += "<section><h2>Distributions and curves</h2><div class='charts'>";
    for (const std::string& chart : content.charts) html += "<div>" + chart + "</div>\n";
    html += "</div></section>\n";
  }
  html += "<section><h2>What was done</h2>";
  for (const ReportStep& step : content.steps) html += stepHtml(step);
  html += "</section></main>\n";
  if (content.evolution) {
    html += "<script type=\"application/json\" id=\"evolution\">" +
            scriptSafe(evolutionJson(*content.evolution)) + "</script>\n";
    html += "<script>\n" + std::string(kThreeScript) + "\n</script>\n<script>\n" + kPageScript +
            "</script>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace explica::report
