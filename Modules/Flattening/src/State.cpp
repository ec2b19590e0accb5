// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/State.h"

#include "Explica/Core/StateFile.h"

namespace explica::flattening {
namespace {

constexpr char kMagic[] = "ExplicaFlat1\n";  // the number counts changes of the format

void write(StateWriter& w, const CutPlan& plan) {
  w.count(static_cast<std::int64_t>(plan.termination));
  w.number(plan.strainBefore);
  w.number(plan.edgeStrain);
  w.count(static_cast<std::int64_t>(plan.cuts.size()));
  for (const Cut& cut : plan.cuts) {
    w.indices(cut.path);
    w.number(cut.length);
    w.number(cut.depth);
  }
  w.count(static_cast<std::int64_t>(plan.found.size()));
  for (const CutPath& path : plan.found) w.indices(path);
}

CutPlan readPlan(StateReader& r) {
  CutPlan plan;
  plan.termination = static_cast<Termination>(r.count());
  plan.strainBefore = r.number();
  plan.edgeStrain = r.number();
  plan.cuts.resize(static_cast<std::size_t>(r.count()));
  for (Cut& cut : plan.cuts) {
    cut.path = r.indices();
    cut.length = r.number();
    cut.depth = r.number();
  }
  plan.found.resize(static_cast<std::size_t>(r.count()));
  for (CutPath& path : plan.found) path = r.indices();
  return plan;
}

}  // namespace

void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  StateWriter w;
  w.raw(&checkpoint.uncut, sizeof checkpoint.uncut);
  w.count(checkpoint.cuts.has_value());
  if (checkpoint.cuts) write(w, *checkpoint.cuts);
  const FlattenState& map = checkpoint.map;
  w.raw(&map.disc, sizeof map.disc);
  w.count(map.level + 1);
  w.number(map.iterations);
  w.number(map.areaWeight);
  w.number(map.areaTolerance);
  w.count(map.settled);
  w.rows(map.positions);
  w.count(static_cast<std::int64_t>(map.path.size()));
  for (const FlatStage& stage : map.path) {
    w.count(stage.level);
    w.rows(stage.positions);
  }
  w.commit(path, kMagic);
}

Checkpoint readCheckpoint(const std::filesystem::path& path) {
  StateReader r(path, kMagic, "a flat map");
  Checkpoint c;
  r.raw(&c.uncut, sizeof c.uncut);
  if (r.count() != 0) c.cuts = readPlan(r);
  r.raw(&c.map.disc, sizeof c.map.disc);
  c.map.level = static_cast<int>(r.count()) - 1;
  c.map.iterations = static_cast<int>(r.number());
  c.map.areaWeight = r.number();
  c.map.areaTolerance = r.number();
  c.map.settled = r.count() != 0;
  c.map.positions = r.rows<FlatPositions>();
  c.map.path.resize(static_cast<std::size_t>(r.count()));
  for (FlatStage& stage : c.map.path) {
    stage.level = static_cast<int>(r.count());
    stage.positions = r.rows<FlatPositions>();
  }
  return c;
}

}  // namespace explica::flattening
