#include <optional>
#include <utility>

#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/HeadModel/SourceError.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::bem {
namespace {

namespace fs = std::filesystem;

ReadVolume readImage(const fs::path& path, const std::string& role, BemRun& run,
                     const ReadOptions& options = {}) {
    ReadVolume read = readVolume(path, options);
    run.model.inputs.push_back({baseName(path), role, read.format});
    addWarnings(run.model.warnings, read.warnings, path.filename().string());
    return read;
}

/// As readImage(), and the surfaces' frame is this image's.
ReadVolume readMainImage(const fs::path& path, const std::string& role, BemRun& run) {
    ReadVolume read = readImage(path, role, run, run.options.read);
    run.model.image = read.volume.view().geometry();
    if (run.options.report.isWanted() && !run.shownImage) run.shownImage = read;
    return read;
}

/// The boundaries that `make` finds. Errors name the option and the file.
template <class Make>
HeadBoundaries timed(BemRun& run, const std::string& option, const fs::path& path,
                     const Make& make) {
    try {
        return run.timer.time("boundaries", make);
    } catch (const SourceError& error) {
        const BemOptions& options = run.options;
        const std::string mask = options.brainMask.empty()
                                     ? "--aseg " + options.aseg.string()
                                     : "--brain-mask " + options.brainMask.string();
        const std::string source = error.source() == BoundarySource::BrainMask ? mask
                                   : error.source() == BoundarySource::Lesion
                                       ? "--lesion " + options.lesion.string()
                                   : error.source() == BoundarySource::HeadMask
                                       ? "--head-mask " + options.headMask.string()
                                       : "--pial";
        throw InvalidInput(source + ": " + error.what());
    } catch (const InvalidInput& error) {
        throw InvalidInput(option + " " + path.string() + ": " + error.what());
    }
}

/// Surfaces of the cortex, in the model's space.
/// \param first  the number of the first one among those that --input-coordinates is for
std::vector<TriangleMesh> readCortex(BemRun& run, const std::vector<fs::path>& paths,
                                     const std::string& option, const std::string& role,
                                     std::size_t first) {
    std::vector<NamedMesh> files;
    for (const fs::path& path : paths) {
        const auto stated = statedFrame(run.options.inputCoordinates, first + files.size());
        files.push_back({path, readMesh(path, {.inputCoordinates = stated})});
        run.model.inputs.push_back(
            {baseName(path), role, std::string(files.back().file.format->name)});
    }
    const CommonFrame common =
        naming(option, [&] { return bringToOneFrame(files, run.model.image); });
    addWarnings(run.model.warnings, common.warnings);
    std::vector<TriangleMesh> surfaces;
    for (NamedMesh& named : files) surfaces.push_back(std::move(named.file.mesh));
    return surfaces;
}

HeadBoundaries fromT1(BemRun& run, const BoundaryOptions& boundaries) {
    const BemOptions& options = run.options;
    std::optional<ReadVolume> t1, mask, aseg, lesion;
    BrainSources brain;
    run.timer.time("read", [&] {
        t1 = readMainImage(options.t1, "t1", run);
        if (!options.brainMask.empty()) mask = readImage(options.brainMask, "brain mask", run);
        if (!options.aseg.empty()) aseg = readImage(options.aseg, "aseg", run);
        if (!options.lesion.empty()) lesion = readImage(options.lesion, "lesion mask", run);
        if (!options.pial.empty()) {
            brain.pial = readCortex(run, options.pial, "--pial", "pial surface", 0);
        }
    });
    if (mask) brain.mask = mask->volume.view();
    if (aseg) brain.aseg = aseg->volume.view();
    if (lesion) brain.lesion = lesion->volume.view();
    run.model.pial = brain.pial;
    return timed(run, "--t1", options.t1,
                 [&] { return boundariesFromT1(t1->volume, brain, boundaries); });
}

HeadBoundaries fromLabels(BemRun& run, const BoundaryOptions& boundaries) {
    const BemOptions& options = run.options;
    std::optional<ReadVolume> labels, mask;
    run.timer.time("read", [&] {
        labels = readMainImage(options.labels, "labels", run);
        if (!options.headMask.empty()) mask = readImage(options.headMask, "head mask", run);
    });
    std::optional<VolumeView> head;
    if (mask) head = mask->volume.view();
    return timed(run, "--labels", options.labels, [&] {
        return boundariesFromLabels(labels->volume, options.tissues, boundaries, head);
    });
}

HeadBoundaries fromProbabilities(BemRun& run, const BoundaryOptions& boundaries) {
    std::vector<ReadVolume> maps;
    run.timer.time("read", [&] {
        for (const fs::path& path : run.options.probabilities) {
            maps.push_back(readMainImage(path, "probabilities", run));
        }
    });
    std::vector<VolumeView> views;
    for (const ReadVolume& map : maps) views.push_back(map.volume.view());
    return timed(run, "--probabilities", run.options.probabilities.front(),
                 [&] { return boundariesFromProbabilities(views, boundaries); });
}

}  // namespace

HeadBoundaries boundariesFromImages(BemRun& run) {
    const BemOptions& options = run.options;
    BoundaryOptions boundaries = options.model.boundaries;
    boundaries.progress = run.progress.callback();
    run.progress.show("read");
    HeadBoundaries result;
    if (run.model.source == "t1") {
        result = fromT1(run, boundaries);
    } else if (run.model.source == "labels") {
        result = fromLabels(run, boundaries);
    } else if (run.model.source == "probabilities") {
        result = fromProbabilities(run, boundaries);
    } else {
        const ReadVolume ct =
            run.timer.time("read", [&] { return readMainImage(options.ct, "ct", run); });
        result =
            timed(run, "--ct", options.ct, [&] { return boundariesFromCt(ct.volume, boundaries); });
    }
    return result;
}

std::vector<TriangleMesh> readSurfaces(BemRun& run) {
    const BemOptions& options = run.options;
    if (!options.volume.empty()) readMainImage(options.volume, "volume", run);
    std::vector<NamedMesh> files;
    for (const fs::path& path : options.surfaces) {
        const auto stated = statedFrame(options.inputCoordinates, files.size());
        files.push_back({path, readMesh(path, {.keepsFaults = true, .inputCoordinates = stated})});
        run.model.inputs.push_back(
            {baseName(path), "surface", std::string(files.back().file.format->name)});
        const MeshFile& file = files.back().file;
        if (file.frame == CoordinateFrame::TkRas && !run.model.tkRasVolume)
            run.model.tkRasVolume = file.volume;
    }
    CommonFrame common = bringToOneFrame(files, run.model.image);
    if (common.frame == CoordinateFrame::TkRas) run.model.tkRasVolume = common.volume;
    if (!common.isKnown) {
        common.warnings.back().text +=
            std::string("; the model's files say scanner RAS mm") + kStateIt;
    }
    addWarnings(run.model.warnings, common.warnings);
    std::vector<TriangleMesh> surfaces;
    for (NamedMesh& named : files) {
        surfaces.push_back(std::move(named.file.mesh));
        freeMemory(surfaces.back().normals);
    }
    return surfaces;
}

void readSources(BemRun& run) {
    const BemOptions& options = run.options;
    if (options.sources.empty()) return;
    run.timer.time("read", [&] {
        run.model.options.sources.surfaces =
            readCortex(run, options.sources, "--sources", "source surface",
                       options.surfaces.size() + options.pial.size());
    });
}

void chooseTkRas(BemRun& run) {
    const BemOptions& options = run.options;
    if (!options.subject.empty()) {
        const fs::path orig = options.subjectsDir / options.subject / "mri" / "orig.mgz";
        std::error_code error;
        if (fs::is_regular_file(orig, error)) {
            run.model.tkRasVolume = readVolume(orig).volume.view().geometry();
            run.model.tkRasName = "orig.mgz";
            return;
        }
        run.model.warnings.push_back(
            {"guessed-frame", "the subject has no mri/orig.mgz; tkRAS is that of the input"});
    }
    if (run.model.image)
        run.model.tkRasVolume = frameVolume(CoordinateFrame::TkRas, *run.model.image);
}

}  // namespace adaptiso::bem
