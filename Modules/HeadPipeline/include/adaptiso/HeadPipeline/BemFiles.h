#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// Which files to write for a head model.
struct BemFileOptions {
    OpenMeegUnit unit = OpenMeegUnit::Millimetres;
    CoordinateFrame frame = CoordinateFrame::Ras;  ///< of all files but FreeSurfer's
    bool writesGifti = false;
    bool writesVtp = false;
    /// bem.fif and, of a model with a skin, head-dense.fif and head-sparse.fif: MNE's, in metres,
    /// in the frame of the FreeSurfer files.
    bool writesFif = false;
    bool writesFieldTrip = false;  ///< headmodel.mat
    /// tess_*_bem.mat, in metres: in SCS where landmarks are known, else in scanner RAS.
    bool writesBrainstorm = false;
    bool writesSimNibs = false;  ///< csf.stl, bone.stl, skin.stl: scanner RAS
    bool writesBemFmm = false;   ///< the same, tissue_index.txt and headmodel.mat
    bool writesBesa = false;     ///< head.sfp: landmarks, electrodes and the skin's points

    bool writesStl() const { return writesSimNibs || writesBemFmm; }
};

/// MNE's files of surfaces.
inline constexpr const char* kFiffModel = "bem.fif";
inline constexpr const char* kFiffDenseHead = "head-dense.fif";
inline constexpr const char* kFiffSparseHead = "head-sparse.fif";
inline constexpr const char* kFiffForward = "lead-field-fwd.fif";

/// Of spongy bone; no layer.
inline constexpr const char* kSpongyBoneSurf = "spongy_bone.surf";

/// Every name that a model's folder may hold.
std::vector<std::string> bemFileNames();

/// "inner_skull.surf"
std::string bemFileName(HeadSurface surface, const char* extension);

/// Writes the model's files: FreeSurfer surfaces, OpenMEEG's set, what else is asked for, and
/// README.md.
/// \param maker  for README.md: "adaptiso-bem 0.2.0"
/// \param place  where to write the file of a name; asked once for each, before it is written
/// \pre model.hasModel()  \throws FileError, InvalidInput  as writeMesh()
void writeBemFiles(const BemModel& model, const BemFileOptions& options, const std::string& maker,
                   const std::function<std::filesystem::path(const std::string& name)>& place);

/// Reads the files back from `folder` and compares them with what should be in them; surfaces are
/// checked as checkModel() checks them, so that no rounding breaks a promise. Every format becomes
/// a check, and what it does not keep a finding.
void checkBemFiles(const std::filesystem::path& folder, const BemFileOptions& options,
                   BemModel& model);

/// OpenMEEG's commands on these files, as far as they lead: to gain.txt from dipoles and
/// electrodes.
std::vector<std::vector<std::string>> openMeegCommands(bool hasDipoles, bool hasElectrodes);

/// From the files' frame to that of MNE's files, mm.
AffineTransform toMriCoordinates(const BemModel& model, const BemFileOptions& options);

}  // namespace adaptiso
