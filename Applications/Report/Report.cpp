// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Pipeline/FolderReport.h"
#include "Explica/Report/Page.h"

#include <filesystem>

namespace explica::app {
namespace {

struct Settings {
  std::string folder;
  std::optional<std::string> page;
  pipeline::FolderReportOptions show;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("one self-contained web page on what a command or a whole run did")
      .description(
          "Shows quality flags with reasons, slices, surfaces, distributions and curves, the "
          "unfolding in an "
          "interactive three-dimensional view, and for each step its command line, options and "
          "results. The "
          "page needs no network and no other file. Steps that failed or stopped are shown as "
          "such.")
      .example("explica report colin", "Writes colin/report.html")
      .example("explica report colin --map sampled/bold.func.gii",
               "The same with a sampled map on the surfaces and on the opened patch")
      .input("DIR", FileKind::Folder, "output folder of a command or of explica run", s.folder)
      .option("Page", Field{"page", "", "file to write (default: report.html in the folder)"},
              s.page)
      .options("Page", s.show)
      .inputOption("map", FileKind::VertexData,
                   "vertex data (of explica sample, say) to show on the surfaces, on the unfolding "
                   "and flat, wherever it fits",
                   s.show.maps, "Page")
      .withoutOutput();
}

Termination run(Context& context, const Settings& s) {
  const std::filesystem::path page =
      s.page ? std::filesystem::path(*s.page) : std::filesystem::path(s.folder) / "report.html";
  writeTextFile(page,
                report::reportPage(pipeline::collectReport(s.folder, s.show, context.monitor())));
  context.info("wrote " + page.string());
  return Termination::NotRun;
}

}  // namespace

Command reportCommand() {
  return makeCommand<Settings>("report", declare, run);
}

}  // namespace explica::app
