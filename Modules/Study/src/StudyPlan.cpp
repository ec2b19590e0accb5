// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyPlan.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;
using Place = std::vector<std::string>;

/// Ways to say one thing: who gives one of them leaves the others.
const std::vector<std::vector<std::string>> kAlternatives = {
    {"unfold.viewpoint", "unfold.direction", "unfold.view-line", "unfold.view-surface"},
    {"unfold.center", "unfold.vertex", "unfold.label", "unfold.region"}};

std::string withoutPrefix(const std::string& label) {
  return label.starts_with("sub-") ? label.substr(4) : label;
}

/// Puts `more` on top; a null takes an option back to its default.
void overlay(Json& values, const Json& more) {
  for (const auto& [key, value] : more.items()) {
    for (const auto& group : kAlternatives) {
      if (std::ranges::find(group, key) == group.end()) continue;
      for (const auto& other : group) values.erase(other);
    }
  }
  for (const auto& [key, value] : more.items()) values[key] = value;
}

Json withPrefix(const Json& object, const std::string& prefix) {
  Json prefixed = Json::object();
  for (const auto& [key, value] : object.items()) prefixed[prefix + key] = value;
  return prefixed;
}

/// Points moved: the coordinates of one or several in a row, or a list of points.
template <class Move>
Json moved(const Json& points, const Move& move) {
  Json all = Json::array();
  if (!points.empty() && points.front().is_array()) {
    for (const Json& point : points) all.push_back(moved(point, move));
    return all;
  }
  for (std::size_t from = 0; from + 3 <= points.size(); from += 3) {
    const Eigen::Vector3d to =
        move(Eigen::Vector3d(points[from], points[from + 1], points[from + 2]));
    for (const double x : to) all.push_back(x);
  }
  return all;
}

/// One study file being taken apart.
class Planner {
 public:
  /// @param labels  subjects that will be asked for; empty: any
  Planner(const StudyFile& file, const PathOptions& paths, const std::vector<std::string>& labels)
      : file_(file), root_(file.values), paths_(paths) {
    if (root_.contains("dataset")) {
      std::vector<std::string> wanted;
      for (const std::string& label : labels) {
        wanted.push_back(withoutPrefix(label.substr(0, label.find("_ses-"))));
      }
      const fs::path dataset = pathOf(root_["dataset"].get<std::string>(), "");
      for (Participant& found : findParticipants(dataset, wanted)) {
        const std::string name = found.name();
        inDataset_.emplace(name, std::move(found));
      }
    }
    if (root_.contains("subjects") && root_["subjects"].is_object()) {
      for (const auto& [key, entry] : root_["subjects"].items()) entries_[key] = &entry;
    }
    if (root_.contains("parameters")) parameters_ = provenance::flattenKeys(root_["parameters"]);
  }

  [[nodiscard]] PlannedSubject plan(const std::string& label) const {
    const std::string key = keyOf(label);
    const Json own = entryOf(label);
    PlannedSubject subject;
    subject.participant = participantOf(label, own, {"subjects", key});
    Json shared = parameters_;
    if (own.contains("parameters")) overlay(shared, provenance::flattenKeys(own["parameters"]));
    const Json hemispheres = own.value("hemispheres", root_.value("hemispheres", Json({"L", "R"})));
    for (const Json& side : hemispheres) {
      const std::string hemisphere = side.get<std::string>();
      const std::string folder = subject.participant.name() + "_hemi-" + hemisphere;
      if (!root_.contains("regions")) {
        subject.runs.push_back({folder, hemisphere, "", finished(shared, label, hemisphere)});
        continue;
      }
      for (const auto& [name, region] : root_["regions"].items()) {
        if (region.contains("hemispheres") &&
            std::ranges::find(region["hemispheres"], side) == region["hemispheres"].end()) {
          continue;
        }
        Json values = shared;
        overlay(values, withPrefix(inSubject(region, own, label, {"regions", name}), "unfold."));
        if (own.contains("regions") && own["regions"].contains(name)) {
          overlay(values, withPrefix(own["regions"][name], "unfold."));
        }
        subject.runs.push_back(
            {folder + "_region-" + name, hemisphere, name, finished(values, label, hemisphere)});
      }
    }
    if (own.contains("regions")) {
      for (const auto& [name, region] : own["regions"].items()) {
        if (root_.contains("regions") && root_["regions"].contains(name)) continue;
        refuse({"subjects", key, "regions", name},
               "the study has no region of this name; add it to regions");
      }
    }
    return subject;
  }

 private:
  [[noreturn]] void refuse(const Place& place, const std::string& what) const {
    throw InvalidInput(placeIn(file_, place) + what);
  }

  /// The subject's key as written: with or without "sub-".
  [[nodiscard]] std::string keyOf(const std::string& label) const {
    return entries_.count("sub-" + label) ? "sub-" + label : label;
  }

  [[nodiscard]] Json entryOf(const std::string& label) const {
    const auto found = entries_.find(keyOf(label));
    return found == entries_.end() || found->second->is_null() ? Json::object() : *found->second;
  }

  /// A path of the file: placeholders filled in, starting at the file's folder.
  [[nodiscard]] std::string pathOf(std::string text, const std::string& label,
                                   const std::string& hemisphere = "") const {
    const auto fill = [&](const std::string& name, const std::string& by) {
      for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + by.size()))
        text.replace(at, name.size(), by);
    };
    fill("{subject}", label);
    if (!hemisphere.empty()) fill("{hemisphere}", hemisphere);
    const fs::path path(text);
    return (path.is_absolute() ? path : file_.path.parent_path() / path)
        .lexically_normal()
        .string();
  }

  [[nodiscard]] Json finished(Json values, const std::string& label,
                              const std::string& hemisphere) const {
    for (auto& [key, value] : values.items()) {
      if (!paths_.count(key)) continue;
      if (value.is_string()) value = pathOf(value.get<std::string>(), label, hemisphere);
      if (!value.is_array()) continue;
      for (Json& one : value) one = pathOf(one.get<std::string>(), label, hemisphere);
    }
    return values;
  }

  [[nodiscard]] Participant participantOf(const std::string& label, const Json& own,
                                          const Place& place) const {
    Participant participant;
    const std::size_t session = label.find("_ses-");
    participant.label = label.substr(0, session);
    if (session != std::string::npos) participant.session = label.substr(session + 5);
    const Json& from = own.contains("input") ? own : root_;
    if (from.contains("input")) {
      participant.input = pathOf(from["input"].get<std::string>(), label);
      const Json& atlas = own.contains("atlas") ? own : root_;
      if (atlas.contains("atlas")) {
        participant.atlas = pathOf(atlas["atlas"].get<std::string>(), label);
      }
      if (!isThere(participant.input)) {
        participant.problem = placeIn(file_, place) + participant.input.string() +
                              " does not exist; mend the path or take the subject out";
      }
      return participant;
    }
    if (!root_.contains("dataset")) {
      refuse(place,
             "has no input; give it one, or the study an input with {subject} in it or a dataset");
    }
    const auto found = inDataset_.find(participant.name());
    if (found == inDataset_.end()) {
      refuse(place, "the data set holds no " + participant.name() +
                        "; mend the label or give the subject an input");
    }
    return found->second;
  }

  [[nodiscard]] Eigen::Matrix4d toCommonOf(const Json& own, const std::string& label,
                                           const Place& region) const {
    const Json& from = own.contains("to-common") ? own : root_;
    if (!from.contains("to-common")) {
      refuse(region, "is in common coordinates, but subject " + label +
                         " has no to-common; give it the matrix from its own coordinates");
    }
    const Json& given = from["to-common"];
    std::vector<double> numbers;
    std::string what = "to-common of subject " + label;
    if (given.is_string()) {
      const std::string path = pathOf(given.get<std::string>(), label);
      what = path;
      std::istringstream text;
      try {
        text.str(fileText(path));
      } catch (const IOError& fault) {
        refuse(region, std::string(fault.what()) + "; it must hold subject " + label +
                           "'s to-common matrix");
      }
      for (double number; text >> number;) numbers.push_back(number);
      if (!text.eof()) numbers.clear();
    } else {
      for (const Json& row : given) {
        for (const Json& number : row) numbers.push_back(number.get<double>());
      }
    }
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    if (numbers.size() != 12 && numbers.size() != 16) {
      refuse(region, what + " does not hold 3 or 4 rows of 4 numbers");
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      matrix(static_cast<int>(i / 4), static_cast<int>(i % 4)) = numbers[i];
    }
    // Of similar scale in all directions, as coordinates of one species of head in mm are.
    const double volume = std::abs(matrix.topLeftCorner<3, 3>().determinant());
    if (!matrix.allFinite() || !(volume > 1e-3 && volume < 1e3) ||
        !matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1))) {
      refuse(region, what + " is not an affine matrix between coordinates in mm");
    }
    return matrix;
  }

  /// A region of the study in a subject's coordinates.
  [[nodiscard]] Json inSubject(Json region, const Json& own, const std::string& label,
                               const Place& place) const {
    const bool common = region.value("space", "subject") == "common";
    region.erase("space");
    region.erase("hemispheres");
    if (!common) return region;
    for (const char* bound : {"vertex", "label", "view-surface"}) {
      if (region.contains(bound)) {
        refuse(place, std::string(bound) +
                          " belongs to one subject's surface and has no common coordinates; use "
                          "center, viewpoint or direction, or give it subject by subject");
      }
    }
    const Eigen::Matrix4d back = toCommonOf(own, label, place).inverse();
    const Eigen::Matrix3d turn = back.topLeftCorner<3, 3>();
    const Eigen::Vector3d shift = back.topRightCorner<3, 1>();
    for (const char* point : {"center", "viewpoint", "view-line"}) {
      if (!region.contains(point)) continue;
      region[point] = moved(region[point], [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        return turn * p + shift;
      });
    }
    if (region.contains("direction")) {
      region["direction"] = moved(
          region["direction"],
          [&](const Eigen::Vector3d& d) -> Eigen::Vector3d { return (turn * d).normalized(); });
    }
    return region;
  }

  const StudyFile& file_;
  const Json& root_;
  const PathOptions& paths_;
  Json parameters_ = Json::object();
  std::map<std::string, const Json*> entries_;    ///< what is particular to subjects, by key
  std::map<std::string, Participant> inDataset_;  ///< by name
};

}  // namespace

std::vector<std::string> subjectsOf(const StudyFile& file) {
  const Json& root = file.values;
  std::vector<std::string> labels;
  if (!root.contains("subjects")) {
    if (!root.contains("dataset")) {
      throw InvalidInput(file.path.string() +
                         ": names no subjects; add subjects, or a dataset to take all of it");
    }
    fs::path dataset = root["dataset"].get<std::string>();
    if (dataset.is_relative()) dataset = file.path.parent_path() / dataset;
    for (const Participant& participant : findParticipants(dataset)) {
      labels.push_back(participant.name().substr(4));
    }
    return labels;
  }
  std::set<std::string> known;
  const auto add = [&](const std::string& label, const std::string& place) {
    if (!known.insert(label).second) {
      throw InvalidInput(placeIn(file, {"subjects", place}) + "subject " + label +
                         " is given twice; remove one");
    }
    labels.push_back(label);
  };
  const Json& subjects = root["subjects"];
  if (subjects.is_array()) {
    for (const Json& label : subjects) {
      add(withoutPrefix(label.is_string() ? label.get<std::string>() : provenance::textOf(label)),
          std::to_string(labels.size()));
    }
  } else {
    for (const auto& [label, entry] : subjects.items()) add(withoutPrefix(label), label);
  }
  return labels;
}

Study planStudy(const StudyFile& file, const PathOptions& paths,
                const std::vector<std::string>& labels) {
  const std::vector<std::string> all = subjectsOf(file);
  std::set<std::string> wanted;
  for (const std::string& label : labels) {
    wanted.insert(withoutPrefix(label));
    if (std::ranges::find(all, withoutPrefix(label)) == all.end()) {
      throw InvalidInput(placeIn(file, {"subjects"}) + "there is no subject " +
                         withoutPrefix(label) + "; `explica study list` names those there are");
    }
  }
  Study study;
  study.name = file.values.value("name", "Explica study");
  const Planner planner(file, paths, labels);
  for (const std::string& label : all) {
    if (wanted.empty() || wanted.count(label)) study.subjects.push_back(planner.plan(label));
  }
  return study;
}

}  // namespace explica::study
