// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Hemisphere.h"
#include "Explica/Core/Results.h"
#include "Explica/Provenance/Options.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace explica::app {

/// What a file holds: said in help, and to the tools that call Explica by its descriptors.
enum class FileKind {
  Volume,       ///< scalar image, 2D or 3D
  LabelVolume,  ///< image of whole numbers
  PointVolume,  ///< image of RAS points or vectors
  Surface,      ///< triangulated surface
  VertexData,   ///< values on a surface's vertices
  VertexLabel,  ///< labels on a surface's vertices
  Grid,         ///< unstructured grid
  Polygon,      ///< closed 2D polygon
  Table,        ///< tab-separated values
  JsonFile,
  Picture,
  Report,  ///< HTML
  Record,  ///< provenance.json
  Folder,
  Any
};
constexpr auto enumWords(FileKind) {
  using enum FileKind;
  return std::to_array<EnumWord<FileKind>>({{Volume, "volume"},
                                            {LabelVolume, "label volume"},
                                            {PointVolume, "point volume"},
                                            {Surface, "surface"},
                                            {VertexData, "vertex data"},
                                            {VertexLabel, "vertex labels"},
                                            {Grid, "grid"},
                                            {Polygon, "polygon"},
                                            {Table, "table"},
                                            {JsonFile, "JSON"},
                                            {Picture, "picture"},
                                            {Report, "report"},
                                            {Record, "provenance record"},
                                            {Folder, "folder"},
                                            {Any, "file"}});
}

/// One thing that the user may give: a positional argument or an option.
struct Parameter {
  provenance::Option option;     ///< name, unit, help, category and where the value goes
  std::optional<FileKind> file;  ///< the value is a path that is read (hashed and recorded)
  bool positional = false;
  bool required = false;
  bool namesOutput = false;           ///< the value says where something is written, beside --out
  bool severalWords = false;          ///< a list option that takes all words up to the next option
  bool oneByOne = false;              ///< its files meet those of other options, but not each other
  const bool* ofAnother = nullptr;    ///< not null: its files are another person's, of another
                                      ///< mesh, and if it is true of any side
  std::optional<Hemisphere> side;     ///< of its files, whatever the other options' are of
  std::vector<std::string> excludes;  ///< options beside which it has no effect, or they have none
  std::vector<std::string>
      needs;                ///< it has no effect without one of these: "label", "method=thesis"
  std::string defaultText;  ///< the default as a user would write it; empty if none
  std::string stepCommand;  ///< the command that include() took it over from; empty: its own
  std::string stepPrefix;   ///< what stands before that command's name of it: "unfold."
};

/// A file that a command writes into its output directory.
struct OutputSlot {
  std::string pattern;  ///< "thickness.nii.gz"; '*' stands for any characters: "frames/frame-*.gii"
  FileKind kind = FileKind::Any;
  std::string help;
  bool varies = false;  ///< holds times or the like: equal runs may give different bytes
};

/// What a command is, said once.  Parser, --help, configuration files, provenance, reference page,
/// descriptors, completion and man page all follow from it.
///
/// The functions that take a reference bind the place where the value is wanted; its present value
/// is the default.
class Declaration {
 public:
  /// One line, without a full stop: "thickness of the tissue between two boundaries".
  Declaration& synopsis(std::string line) { return set(synopsisText, std::move(line)); }
  /// A paragraph or two on what is computed and when to use which option.
  Declaration& description(std::string text) { return set(descriptionText, std::move(text)); }
  /// A paper, as "Jones, Buchbinder, Aharon 2000, Human Brain Mapping 11:12-32".
  Declaration& reference(std::string citation) { return append(references, std::move(citation)); }
  /// A command line that works, and what it does.
  Declaration& example(std::string commandLine, std::string what) {
    return append(examples, Example{std::move(commandLine), std::move(what)});
  }

  /// A file to read, by position.  `name` in capitals: "SEG".  A std::optional<std::string> may be
  /// left out; a std::vector<std::string> takes one or more.
  template <class Path>
  Declaration& input(const std::string& inputName, FileKind kind, const std::string& help,
                     Path& path) {
    return add(provenance::makeOption(Field{inputName, "", help}, path), "", true,
               !provenance::detail::Held<Path>::isOptional, kind);
  }

  /// A file to read, by option: --mask FILE; a std::optional.  A vector's option may be repeated.
  template <class Path>
  Declaration& inputOption(const std::string& optionName, FileKind kind, const std::string& help,
                           Path& path, const std::string& category = "Inputs") {
    return add(provenance::makeOption(Field{optionName, "", help}, path), category, false, false,
               kind);
  }

  /// A word by position that is not a file: participant|group.
  template <class T>
  Declaration& argument(const Field& field, T& value) {
    return add(provenance::makeOption(field, value), "", true, true);
  }

  /// The heading of help that the next options stand under.
  Declaration& category(std::string heading) { return set(category_, std::move(heading)); }
  /// One option.
  template <class T>
  Declaration& option(const Field& field, T& value) {
    return add(provenance::makeOption(field, value), category_, false, false);
  }
  /// One without a unit and of any value.
  template <class T>
  Declaration& option(std::string_view optionName, std::string_view help, T& value) {
    return option(Field{optionName, "", help}, value);
  }

  /// All options of a struct that has a `describe` function (Core/Describe.h).  `prefix` goes
  /// before each name: "unfold." gives --unfold.radius.
  template <class Options>
  Declaration& options(const std::string& category, Options& values, std::string_view prefix = {}) {
    for (auto& listed : provenance::listOptions(values, prefix)) {
      add(std::move(listed), category, false, false);
    }
    return *this;
  }

  // Of an option or positional declared before.
  /// A list option takes every word up to the next option: --participant-label 01 02.  Only for
  /// commands whose positionals users put first.
  Declaration& severalWords(std::string_view of) { return set(get(of).severalWords, true); }
  /// It names a place where something is written, so that a stranger's record cannot set it to any
  /// file of this machine.
  Declaration& namesOutput(std::string_view of) { return set(get(of).namesOutput, true); }
  /// Its files are of this side of the brain: --left.
  Declaration& ofSide(std::string_view of, Hemisphere side) { return set(get(of).side, side); }
  /// Its files are another person's: of another mesh; while `*mirrored`, of any side.
  Declaration& ofAnother(std::string_view of, const bool& mirrored) {
    return set(get(of).ofAnother, &mirrored);
  }
  /// Each of its files stands for itself, so that they may be of both sides.
  Declaration& oneByOne(std::string_view of) { return set(get(of).oneByOne, true); }
  /// It and any of the others would leave one of the two without effect.
  Declaration& excludes(const std::string& name, const std::vector<std::string>& others);
  /// Each of the options has no effect unless one of the conditions holds: an option that is given
  /// ("label"), or one that has a value ("method=thesis").
  Declaration& needs(const std::vector<std::string>& names,
                     const std::vector<std::string>& conditions);
  /// It must be given.
  Declaration& require(std::string_view of) { return set(get(of).required, true); }
  /// It is left out, e.g. one of a struct that makes no sense here.
  Declaration& without(std::string_view unwanted);
  /// Takes over every option (not the positionals) of another declaration, names prefixed.
  Declaration& include(const Declaration& other, std::string_view prefix);

  /// A file written into --out.
  Declaration& output(std::string pattern, FileKind kind, std::string help) {
    return append(outputs, OutputSlot{std::move(pattern), kind, std::move(help), false});
  }
  /// As output(), for a file whose bytes hold times or the like.
  Declaration& varyingOutput(std::string pattern, FileKind kind, std::string help) {
    return append(outputs, OutputSlot{std::move(pattern), kind, std::move(help), true});
  }
  /// What `context.results(stage)` will say: the results that `describe(Results&, const Stage&)`
  /// lists (Core/Results.h), here of a default-constructed one.
  template <class Stage>
  Declaration& results() {
    Results listed;
    describe(listed, Stage{});
    stageResults.include(listed);
    return *this;
  }
  /// The command writes no directory: no --out, no summary, no record.
  Declaration& withoutOutput() { return set(writesOutput, false); }
  /// Outputs go straight into --out, which may hold files already: for commands made of steps that
  /// each keep whole-or-not-at-all themselves.
  Declaration& inPlace() { return set(writesInPlace, true); }
  /// The results of --out are another command's, run by Context::runThrough.
  Declaration& writesThrough() { return set(handsOutputOn, true); }
  /// While `*isOn`, --out may hold files already (as with --resume).
  Declaration& reuseOutputIf(const bool& isOn) { return set(reuse, &isOn); }
  /// Which share of an inPlace() folder's work the options ask for: runs on different shares may be
  /// at work at the same time.  The name is part of a file's; empty: all of it.
  Declaration& shareOfWork(std::function<std::string()> nameOfShare) {
    return set(share, std::move(nameOfShare));
  }
  /// Where to write if --out is not given.
  Declaration& defaultOut(const std::string& folder) { return set(fallbackOut, &folder); }

  /// The option or positional of that name, or nullptr.
  [[nodiscard]] Parameter* find(std::string_view name);
  [[nodiscard]] const Parameter* find(std::string_view name) const;

  std::string name;  ///< as typed: "thickness", "phantom shell"
  std::string synopsisText;
  std::string descriptionText;
  std::vector<std::string> references;
  struct Example {
    std::string commandLine, what;
  };
  std::vector<Example> examples;
  std::vector<Parameter> parameters;  ///< in order of declaration
  std::vector<OutputSlot> outputs;
  Results stageResults;
  bool writesOutput = true;
  bool writesInPlace = false;
  bool handsOutputOn = false;
  const bool* reuse = nullptr;
  std::function<std::string()> share;
  const std::string* fallbackOut = nullptr;

 private:
  template <class T, class Value>
  Declaration& set(T& member, Value&& value) {
    member = std::forward<Value>(value);
    return *this;
  }
  template <class T>
  Declaration& append(std::vector<T>& list, T one) {
    list.push_back(std::move(one));
    return *this;
  }
  /// @throws std::logic_error  there is no option or positional of that name
  Parameter& get(std::string_view name);
  Declaration& add(provenance::Option option, const std::string& category, bool positional,
                   bool required, std::optional<FileKind> file = {});

  std::string category_;
};

}  // namespace explica::app
