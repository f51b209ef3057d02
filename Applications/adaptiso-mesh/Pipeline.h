#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/BatchOptions.h"
#include "Common/CommonOptions.h"
#include "Common/ImageOptions.h"
#include "Common/PrintScale.h"
#include "Common/ReportOutput.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::mesher {

/// An isovalue as asked for.
struct IsovalueChoice {
    std::optional<double> value;  ///< empty: chosen by Otsu's method

    bool isAutomatic() const { return !value; }
    friend bool operator==(const IsovalueChoice&, const IsovalueChoice&) = default;
};

/// Options of adaptiso-mesh.
struct MeshOptions {
    std::vector<std::filesystem::path> inputs;  ///< as given
    std::filesystem::path input;                ///< the one, when it is one
    BatchOptions batch;
    ImageOptions image;
    PreprocessOptions preprocessing;
    std::vector<IsovalueChoice> isovalues;
    std::filesystem::path output;  ///< empty: named after the input, in the current folder
    ExtractionOptions extraction;  ///< of every surface, without isovalue and progress
    IndexOptions index;
    ComponentSelection selection;
    std::optional<CoordinateFrame> frame;  ///< empty: the output format's own
    PrintScale scale;
    bool checksCrossings = true;
    bool verifies = false;  ///< checks the method adaptive's promises by other means, too
    ReportOptions report;
    CommonOptions common;

    /// Whether each input is a run of its own (Batch.h).
    bool isBatch() const {
        return batch.isRequested() || inputs.size() > 1 || holdsName(output) ||
               holdsName(report.page) || holdsName(report.pictures);
    }
    /// Whether the selection of pieces needs closed surfaces.
    bool needsClosedSurfaces() const {
        return selection.fillCavities || selection.minVolumeMm3 > 0;
    }
};

/// Reads the volume, extracts and checks the surfaces, and writes all of them or none; or lists the
/// input's series, or prints what the image holds.
/// \return an exit code
/// \throws UsageError     the output's format is unknown or can't hold the frame
/// \throws FileError      the input can't be read, the output can't be written
/// \throws InvalidInput   preprocessing that can't be done, an isovalue that cuts nothing, nothing
/// is left of a surface, or an index
///                        that is not the volume's
/// \throws InternalError  a surface is not sound
int runMesh(const MeshOptions& asked);

}  // namespace adaptiso::mesher
