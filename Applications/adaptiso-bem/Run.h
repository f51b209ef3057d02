#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Common/ProgramRun.h"
#include "Pipeline.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso::bem {

/// One run of the program, for the reports.
struct BemRun : ProgramRun {
    explicit BemRun(const BemOptions& given)
        : ProgramRun("adaptiso-bem", given.common, given.report, "so no model was written"),
          options(given) {}

    const BemOptions& options;
    BemModel model;
    std::vector<std::pair<std::string, std::uintmax_t>> files{};  ///< files of the folder, by name
    std::vector<std::filesystem::path> subjectFiles{};
    std::map<std::filesystem::path, std::string> scalings{};  ///< ReadVolume::scaling of images
    std::optional<ReadVolume> shownImage{};  ///< for the report; empty unless one is wanted

    /// Takes over the model's warnings and prints those that are new.
    void takeWarnings() {
        warnings = model.warnings;
        printNewWarnings();
    }
};

/// Reads the images asked for and finds the head's boundaries in them. Fills the model's inputs,
/// warnings of reading, and image.
/// \throws FileError, InvalidInput
HeadBoundaries boundariesFromImages(BemRun& run, const BemHooks& hooks);

/// Reads the surfaces asked for, in LPS mm (bringToOneFrame()), inside out.
/// \throws FileError, InvalidInput
std::vector<TriangleMesh> readSurfaces(BemRun& run);

/// Reads the surfaces that --sources names. \pre the main image, or the surfaces, are read
/// \throws FileError, InvalidInput
void readSources(BemRun& run);

/// Which volume's tkRAS the FreeSurfer files will be in: the subject's own mri/orig.mgz where there
/// is one, else the image's (frameVolume()), else that of the surfaces read, else none.
/// \throws FileError
void chooseTkRas(BemRun& run);

/// Names the solver of --lead-field that is not installed; empty: all is there.
std::string missingSolver(const BemModelOptions& options);

/// Has the lead field made of the model's files, in a folder of its own. Fills the model's.
/// \pre a model, with electrodes and sources
/// \throws FileError  it fails; a file that is named holds what it printed
void solveLeadField(BemRun& run);

/// The report, as README.md describes it: schema "adaptiso-bem/1". Holds file names without
/// folders. A number that is not known, or not finite, is null.
std::string jsonReport(const BemRun& run);

/// Prints the text report: surfaces, gaps, guesses and files written.
void printReport(std::ostream& out, const BemRun& run);

}  // namespace adaptiso::bem
