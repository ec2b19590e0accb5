// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Pipeline/FolderReport.h"
#include "Explica/Report/Page.h"

#include <filesystem>

namespace explica::app {
namespace {

struct ReportSettings {
  std::string folder;
  std::optional<std::string> page;
  std::optional<std::string> out;
  pipeline::FolderReportOptions show;
};

void declare(Declaration& d, ReportSettings& s) {
  d.synopsis("one self-contained web page on what a command or a whole run did")
      .description(
          R"(Shows quality flags with reasons, slices, surfaces, distributions and curves, the unfolding in an interactive three-dimensional view, and for each step its command line, options and results. The page needs no network and no other file. Steps that failed or stopped are shown as such.)")
      .example("explica report colin", "Writes colin/report.html")
      .example("explica report colin --map sampled/bold.func.gii",
               "The same with a sampled map on the surfaces and on the opened patch")
      .input("DIR", FileKind::Folder, "output folder of a command or of explica run", s.folder)
      .category("Page")
      .option("page", "file to write (default: report.html in the folder)", s.page)
      .option("out", "new folder to write report.html into, instead of --page", s.out)
      .options("Page", s.show)
      .inputOption("map", FileKind::VertexData,
                   "vertex data (of explica sample, say) to show on the surfaces, on the unfolding "
                   "and flat, wherever it fits",
                   s.show.maps, "Page")
      .oneByOne("map")
      .excludes("out", {"page"})
      .withoutOutput();
}

std::filesystem::path pageOf(const ReportSettings& s) {
  namespace fs = std::filesystem;
  if (s.page) return *s.page;
  if (!s.out) return fs::path(s.folder) / "report.html";
  if (isThere(*s.out)) {
    throw InvalidInput("--out: '" + *s.out + "' exists already; choose another folder");
  }
  return fs::path(*s.out) / "report.html";
}

void makeFolder(const std::filesystem::path& folder) {
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (fault) {
    throw EnvironmentError("cannot make the folder '" + folder.string() + "': " + fault.message());
  }
}

Termination run(Context& context, const ReportSettings& s) {
  const std::filesystem::path page = pageOf(s);
  const std::string text =
      report::reportPage(pipeline::collectReport(s.folder, s.show, context.monitor()));
  if (s.out) makeFolder(*s.out);
  writeTextFile(page, text);
  context.info("wrote " + page.string());
  return Termination::NotRun;
}

}  // namespace

Command reportCommand() {
  return makeCommand<ReportSettings>("report", declare, run);
}

}  // namespace explica::app
