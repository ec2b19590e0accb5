// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/SubjectFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"

#include <algorithm>
#include <iterator>
#include <system_error>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using Found = std::optional<fs::path>;

std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code fault;
  for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    entries.push_back(at->path());
  }
  if (fault) throw IOError(folder.string() + ": cannot be read (" + fault.message() + ")");
  std::ranges::sort(entries);
  return entries;
}

Found ifThere(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) ? Found(path) : std::nullopt;
}

/// Keeps a pair of surfaces only if it is whole.
void settlePair(HemisphereFiles& surfaces, const std::string& white, const std::string& pial,
                std::vector<std::string>& remarks) {
  if (surfaces.white.has_value() == surfaces.pial.has_value()) return;
  remarks.push_back((surfaces.white ? pial : white) +
                    " is not there: " + (surfaces.white ? white : pial) + " alone is not used");
  surfaces = {};
}

HemisphereFiles freeSurferSurfaces(const fs::path& subject, const std::string& hemi,
                                   std::vector<std::string>& remarks) {
  HemisphereFiles surfaces;
  surfaces.white = ifThere(subject / "surf" / (hemi + ".white"));
  surfaces.pial = ifThere(subject / "surf" / (hemi + ".pial"));
  settlePair(surfaces, "surf/" + hemi + ".white", "surf/" + hemi + ".pial", remarks);
  if (surfaces.white) surfaces.parcellation = ifThere(subject / "label" / (hemi + ".aparc.annot"));
  return surfaces;
}

SubjectFiles inFreeSurferSubject(const fs::path& subject) {
  SubjectFiles files;
  files.layout = SubjectLayout::FreeSurfer;
  const fs::path mri = subject / "mri";
  files.labels = ifThere(mri / "ribbon.mgz");
  if (!files.labels) {
    files.labels = ifThere(mri / "aseg.mgz");
    if (files.labels)
      files.remarks.emplace_back("mri/ribbon.mgz is not there: mri/aseg.mgz is used");
  }
  files.image = ifThere(mri / "brain.mgz");
  if (!files.image) files.image = ifThere(mri / "norm.mgz");
  files.atlas = ifThere(mri / "aparc+aseg.mgz");
  files.left = freeSurferSurfaces(subject, "lh", files.remarks);
  files.right = freeSurferSurfaces(subject, "rh", files.remarks);
  for (const char* name : {"orig.mgz", "T1.mgz", "brain.mgz", "ribbon.mgz", "aseg.mgz"}) {
    if (!files.surfaceVolume) files.surfaceVolume = ifThere(mri / name);
  }
  if (!files.labels && !files.left.white && !files.right.white) {
    throw InvalidInput(subject.string() +
                       ": holds neither mri/ribbon.mgz nor mri/aseg.mgz nor surf/?h.white with "
                       "surf/?h.pial; let recon-all finish first");
  }
  return files;
}

/// Files of one anat folder, asked by the end of their names.
class AnatFolder {
 public:
  explicit AnatFolder(const fs::path& folder) {
    for (const fs::path& entry : entriesOf(folder)) {
      const std::string name = entry.filename().string();
      if (name.starts_with("sub-") && name.find("_space-") == std::string::npos) {
        files_.push_back(entry);
      }
    }
  }

  /// The first by name; with an entity such as "_atlas-" in it, if asked for.
  [[nodiscard]] Found ending(std::string_view end, std::string_view entity = "") const {
    for (const fs::path& file : files_) {
      const std::string name = file.filename().string();
      if (name.ends_with(end) && name.find(entity) != std::string::npos) return file;
    }
    return std::nullopt;
  }

  /// A volume, packed or not.
  [[nodiscard]] Found volume(const std::string& end, std::string_view entity = "") const {
    const Found packed = ending(end + ".nii.gz", entity);
    return packed ? packed : ending(end + ".nii", entity);
  }

  /// Of several T1 images the first by name, those with a contrast agent last.
  [[nodiscard]] Found t1(std::vector<std::string>& remarks) const {
    std::vector<fs::path> found;
    std::ranges::copy_if(files_, std::back_inserter(found), [](const fs::path& file) {
      return file.string().ends_with("_T1w.nii.gz") || file.string().ends_with("_T1w.nii");
    });
    if (found.empty()) return std::nullopt;
    std::ranges::stable_partition(found, [](const fs::path& file) {
      return file.filename().string().find("_ce-") == std::string::npos;
    });
    if (found.size() > 1) {
      remarks.push_back("of " + std::to_string(found.size()) + " T1 images " +
                        found.front().filename().string() + " is used");
    }
    return found.front();
  }

  [[nodiscard]] HemisphereFiles surfaces(const std::string& side,
                                         std::vector<std::string>& remarks) const {
    const std::string hemi = "_hemi-" + side;
    const auto surface = [&](const std::string& suffix) {
      return ending(hemi + "_" + suffix + ".surf.gii");
    };
    HemisphereFiles found;
    found.white = surface("white");
    if (!found.white) found.white = surface("smoothwm");
    found.pial = surface("pial");
    found.mid = surface("midthickness");
    settlePair(found, "*" + hemi + "_white.surf.gii", "*" + hemi + "_pial.surf.gii", remarks);
    if (found.white) found.parcellation = ending("_dseg.label.gii", hemi);
    return found;
  }

 private:
  std::vector<fs::path> files_;
};

SubjectFiles inAnatFolder(const fs::path& folder) {
  const AnatFolder anat(folder);
  SubjectFiles files;
  files.layout = SubjectLayout::Bids;
  files.left = anat.surfaces("L", files.remarks);
  files.right = anat.surfaces("R", files.remarks);

  const Found aseg = anat.volume("_desc-aseg_dseg");
  const Found parcels = anat.volume("_desc-aparcaseg_dseg");
  const Found atlas = anat.volume("_dseg", "_atlas-");
  files.atlas = parcels ? parcels : atlas;
  files.labels = aseg ? aseg : parcels;
  if (files.labels) return files;

  const Found brain = anat.volume("_desc-brain_T1w");
  const Found whole = anat.volume("_desc-preproc_T1w");
  const Found mask = anat.volume("_desc-brain_mask");
  if (atlas && (brain || (whole && mask))) {
    files.t1 = brain ? brain : whole;
    if (!brain) files.mask = mask;
    return files;
  }
  files.labels = anat.volume("_dseg");
  if (files.labels && files.labels == atlas) files.labels.reset();
  if (files.labels || files.left.white || files.right.white) return files;

  // A head as it is: a template says where the brain is, and which half is which.
  files.t1 = brain ? brain : (whole ? whole : anat.t1(files.remarks));
  if (files.t1) {
    if (!brain && whole) files.mask = mask;
    return files;
  }
  throw InvalidInput(folder.string() +
                     ": holds no segmentation (*_dseg.nii.gz), no surfaces "
                     "(*_hemi-L_white.surf.gii) and no T1 (*_T1w.nii.gz)");
}

}  // namespace

SubjectFiles findSubjectFiles(const fs::path& folder) {
  if (!isFolder(folder)) throw InvalidInput(folder.string() + ": is not a folder");
  const auto entries = entriesOf(folder);
  const auto has = [&](const std::string& name) {
    return std::ranges::any_of(entries,
                               [&](const fs::path& entry) { return entry.filename() == name; });
  };
  if (has("mri") || has("surf")) return inFreeSurferSubject(folder);
  if (has("anat")) return inAnatFolder(folder / "anat");
  const bool session = std::ranges::any_of(
      entries, [](const fs::path& entry) { return entry.filename().string().starts_with("ses-"); });
  if (session) {
    throw InvalidInput(folder.string() + ": holds sessions; name one of them, as " +
                       (folder / "ses-01").string());
  }
  if (folder.filename() == "anat" || std::ranges::any_of(entries, [](const fs::path& entry) {
        return entry.filename().string().starts_with("sub-") && !isFolder(entry);
      })) {
    return inAnatFolder(folder);
  }
  throw InvalidInput(folder.string() +
                     ": is neither a FreeSurfer subject directory (mri/ribbon.mgz) nor a BIDS "
                     "subject (anat/sub-*_dseg.nii.gz); give one of these, a T1 or a label volume");
}

}  // namespace explica::study
