#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/Pipeline/BemModel.h"

namespace adaptiso {

/// In what a head model is written.
struct BemFileOptions {
    OpenMeegUnit unit = OpenMeegUnit::Millimetres;
    CoordinateFrame frame = CoordinateFrame::Ras;  ///< of all files but FreeSurfer's
    bool writesGifti = false;
    bool writesVtp = false;
};

/// Every name that a model's folder may hold.
std::vector<std::string_view> bemFileNames();

/// "inner_skull.surf" of surface 0
std::string bemFileName(std::size_t surface, const char* extension);

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
