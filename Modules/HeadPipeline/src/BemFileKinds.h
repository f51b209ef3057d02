#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adaptiso/HeadPipeline/BemFiles.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// Where to write the file of a name.
using PlaceFile = std::function<std::filesystem::path(const std::string& name)>;

/// Files of one format: how they come about, and how their surfaces come back.
struct BemFileKind {
    std::string name;                         ///< for findings: "*.surf"
    AffineTransform fromLps;                  ///< of the points stored
    double unitMm = 1;                        ///< of the points stored
    std::vector<const TriangleMesh*> meshes;  ///< that they hold, from inside out
    std::vector<double> gapsMm{};             ///< promised between these
    bool keepsPromises = true;  ///< they are the model's, not just pictures of the head
    std::function<void(const PlaceFile&)> write;
    /// The surfaces as stored. \throws FileError
    std::function<std::vector<TriangleMesh>(const std::filesystem::path& folder)> read;
};

/// All kinds that are asked for. What is returned refers to `model`.
/// \pre model.hasModel(), and it has all its meshes
std::vector<BemFileKind> bemFileKinds(const BemModel& model, const BemFileOptions& options);

}  // namespace adaptiso
