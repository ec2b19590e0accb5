// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// `explica flatten` on one person's hemisphere at full resolution.  Nothing here depends on the
// clock.

#include "Explica/IO/SurfaceFile.h"
#include "Explica/Testing/Command.h"
#include "RealSurfaces.h"

namespace explica::testing {
namespace {

class FlattenAtFullResolution : public RealSurfaces {
 protected:
  static CommandResult patiently(const std::vector<std::string>& words) {
    CommandSetting setting;
    setting.timeout = 1000;
    return explica(words, setting);
  }
};

TEST_F(FlattenAtFullResolution, CutByItselfIsAsGoodAsWithCutsMadeByHand) {
  const TemporaryFolder folder;
  io::LoadedSurface mid = io::readSurface(data() / "s1_pycortex_lh/wm_lh.gii");
  mid.mesh.positions =
      ((mid.mesh.positions + io::readSurface(individual()).mesh.positions) / 2).eval();
  const std::string surface = folder / "mid.surf.gii";
  io::writeGiftiSurface(surface, mid.mesh, mid.metadata);
  const auto byHand =
      patiently({"flatten", surface, "--cuts", (data() / "s1_pycortex_lh/flat_lh.gii").string(),
                 "--out", folder / "hand"});
  ASSERT_EQ(byHand.exitCode, 0) << byHand;
  const auto made = patiently({"flatten", surface, "--cuts", "auto", "--out", folder / "auto"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto hand = readJson(folder / "hand/summary.json"),
             ours = readJson(folder / "auto/summary.json");
  for (const auto& summary : {hand, ours}) {
    EXPECT_EQ(summary["turned_over"], 0);
    EXPECT_EQ(summary["rim_crossings"], 0);
    EXPECT_LE(summary["area_error_mean"], 0.05);
  }
  // pycortex's own map: 12.0 and 8.2 %.
  EXPECT_LE(hand["geodesic_error_local"], 0.120);
  EXPECT_LE(hand["geodesic_error_all"], 0.082);
  EXPECT_LE(ours["geodesic_error_local"], 1.1 * double(hand["geodesic_error_local"]));
  EXPECT_LE(ours["geodesic_error_all"], 1.1 * double(hand["geodesic_error_all"]));
  EXPECT_LE(ours["cut_length"], 600);
}

}  // namespace
}  // namespace explica::testing
