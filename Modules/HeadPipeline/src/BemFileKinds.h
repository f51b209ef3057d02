#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/HeadPipeline/BemFiles.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// Where to write the file of a name.
using PlaceFile = std::function<std::filesystem::path(const std::string& name)>;

/// A model, and how its files are to hold it.
struct BemFileSource {
    const BemModel& model;
    const BemFileOptions& options;

    HeadSurface surface(std::size_t n) const { return headSurface(n, model.meshes.size()); }
    std::optional<ImageGeometry> volume(CoordinateFrame frame) const {
        return frame == CoordinateFrame::TkRas ? model.tkRasVolume : std::nullopt;
    }
    /// Of FreeSurfer's files and MNE's.
    CoordinateFrame mriFrame() const {
        return model.tkRasVolume ? CoordinateFrame::TkRas : CoordinateFrame::Ras;
    }
    AffineTransform into(CoordinateFrame frame) const { return lpsToFrame(frame, volume(frame)); }
    double conductivity(std::size_t n) const {
        return model.options.conductivities.within(surface(n), model.meshes.size());
    }
    bool hasLandmarks() const { return model.electrodes && model.electrodes->landmarks; }

    /// A finding at the model's first vertex.
    Finding fault(std::string what) const {
        return {std::move(what), model.meshes.front().points.front()};
    }
};

/// A fault of written files, and its place; empty without a fault.
using BemFileFault = std::optional<Finding>;

/// How files of one format are written and read back.
struct BemFileKind {
    std::function<void(const PlaceFile&)> write;
    /// Compares the files with what should be in them. \throws FileError  unreadable
    std::function<BemFileFault(const std::filesystem::path& folder)> check;
};

/// A row: files of one format.
struct BemFileRow {
    std::string_view name;  ///< for checks: "*.surf"
    /// Names of all files; one for each HeadSurface where each has its own.
    std::vector<std::string> files;
    bool (*isWanted)(const BemFileSource&);
    BemFileKind (*kind)(const BemFileSource&, const std::vector<std::string>& files);
    std::string_view promise = "the same when read back";
};

/// How far a point may lie from where it was, mm: float's rounding at 500 mm from the origin, with
/// room. An error of frame or unit is larger by far.
inline constexpr double kFileRoundingMm = 1e-3;

inline constexpr const char* kSpongyStl = "spongy.stl";

/// By HeadSurface, as SimNIBS 3 names them.
std::vector<std::string> stlFileNames();

/// Rows of electrodes, sources, tetrahedra and texts.
std::vector<BemFileRow> pointFileRows();

/// All rows, in the order in which files are written and checked.
const std::vector<BemFileRow>& bemFileRows();

}  // namespace adaptiso
