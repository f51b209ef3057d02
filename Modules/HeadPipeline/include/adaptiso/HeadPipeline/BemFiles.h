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
    bool writesBrainstorm =
        false;  ///< tess_*_bem.mat: SCS of landmarks that are known, else scanner RAS; metres
    bool writesSimNibs = false;  ///< csf.stl, bone.stl, skin.stl: scanner RAS
    bool writesBesa = false;     ///< head.sfp: landmarks, electrodes and the skin's points
};

/// Files of a model with electrodes: BIDS, ASA, BESA, FIFF, and OpenMEEG's (three numbers a line).
inline constexpr const char* kElectrodesTsv = "electrodes.tsv";
inline constexpr const char* kElectrodesJson = "coordsystem.json";
inline constexpr const char* kElectrodesElc = "electrodes.elc";
inline constexpr const char* kElectrodesSfp = "electrodes.sfp";
inline constexpr const char* kElectrodesFif = "electrodes-dig.fif";
inline constexpr const char* kElectrodesTxt = "electrodes.txt";
inline constexpr const char* kBesaFile = "head.sfp";
/// Files of a model with sources: a line "x y z ox oy oz" a dipole, and MNE's source space.
inline constexpr const char* kDipolesTxt = "dipoles.txt";
inline constexpr const char* kSourcesFif = "sources-src.fif";
/// File of a model with landmarks: MNE's head coordinates to those of the .surf and .fif files.
inline constexpr const char* kHeadToMriFif = "head-mri-trans.fif";
/// Files of a model with tetrahedra, in BemFileOptions::frame, mm.
inline constexpr const char* kMsh22File = "head.msh";
inline constexpr const char* kMsh41File = "head-4.1.msh";
inline constexpr const char* kVtuFile = "head.vtu";
inline constexpr const char* kDgfFile = "head.dgf";
inline constexpr const char* kTissueConductivitiesFile = "head.cond";

inline constexpr const char* kFiffModel = "bem.fif";
inline constexpr const char* kFiffDenseHead = "head-dense.fif";
inline constexpr const char* kFiffSparseHead = "head-sparse.fif";
inline constexpr const char* kFieldTripFile = "headmodel.mat";

/// File name of a surface: "csf.stl", "tess_innerskull_bem.mat".
std::string simNibsName(HeadSurface surface);
std::string brainstormName(HeadSurface surface);

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

/// Reads the model's files back from `folder` and asks them once more what checkModel() asks:
/// rounding to what a format can hold must not break a promise, and every file must lead back to
/// the surfaces. What is not kept becomes a finding.
/// \throws FileError  OpenMEEG's files break a rule of its readers
void checkBemFiles(const std::filesystem::path& folder, const BemFileOptions& options,
                   BemModel& model);

}  // namespace adaptiso
