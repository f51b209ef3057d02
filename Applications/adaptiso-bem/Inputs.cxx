#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::bem {
namespace {

namespace fs = std::filesystem;

/// Records an image for the reports.
ReadVolume recorded(ReadVolume read, const fs::path& path, const std::string& role, BemRun& run) {
    run.model.inputs.push_back({baseName(path), role, read.format});
    if (!read.scaling.empty()) run.scalings[path] = read.scaling;
    addWarnings(run.model.warnings, read.warnings, path.filename().string());
    return read;
}

/// The image whose frame is that of the surfaces.
ReadVolume readMainImage(const fs::path& path, const std::string& role, BemRun& run) {
    ReadVolume read = recorded(readImage(path, run.options.read), path, role, run);
    run.model.image = read.volume.view().geometry();
    if (run.options.report.isWanted() && !run.shownImage) run.shownImage = read;
    return read;
}

/// The boundaries in `images`. Errors name the option and the file.
HeadBoundaries boundariesIn(const BemImages& images, const BemRun& run, const BemHooks& hooks) {
    const BemOptions& options = run.options;
    const std::map<std::string, fs::path> files{
        {"t1", options.t1},         {"brain-mask", options.brainMask},
        {"aseg", options.aseg},     {"lesion", options.lesion},
        {"labels", options.labels}, {"head-mask", options.headMask},
        {"ct", options.ct},
    };
    const auto naming = [&](const std::string& name) {
        const auto file = files.find(name);
        if (name == "probabilities") return "--" + name + " " + options.probabilities[0].string();
        if (file == files.end()) return "--" + name;
        const auto scaling = run.scalings.find(file->second);
        const bool areLabels = name == "labels" || name == "aseg";
        return "--" + name + " " + file->second.string() +
               (areLabels && scaling != run.scalings.end()
                    ? " (its header scales the stored values: " + scaling->second + ")"
                    : "");
    };
    return findBoundaries(run.model, images, hooks, naming);
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
        addWarnings(run.model.warnings, files.back().file.warnings, baseName(path));
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

}  // namespace

HeadBoundaries boundariesFromImages(BemRun& run, const BemHooks& hooks) {
    const BemOptions& options = run.options;
    const BemSource source = run.model.source;
    run.progress.show("read");
    std::deque<ReadVolume> read;  // what views are of
    BemImages images;
    images.tissues = options.tissues;
    const auto readMask = [&](const fs::path& path, const char* role,
                              std::optional<VolumeView>& view) {
        if (path.empty()) return;
        view = read.emplace_back(recorded(readOnlyImage(path), path, role, run)).volume.view();
    };
    run.timer.time("read", [&] {
        std::vector<fs::path> main{source == BemSource::T1       ? options.t1
                                   : source == BemSource::Labels ? options.labels
                                                                 : options.ct};
        if (source == BemSource::Probabilities) main = options.probabilities;
        for (const fs::path& path : main) {
            images.main.push_back(
                read.emplace_back(readMainImage(path, toString(source), run)).volume.view());
        }
        readMask(options.brainMask, "brain mask", images.brain.mask);
        readMask(options.aseg, "aseg", images.brain.aseg);
        readMask(options.lesion, "lesion mask", images.brain.lesion);
        readMask(options.headMask, "head mask", images.headMask);
        if (!options.pial.empty()) {
            images.brain.pial = readCortex(run, options.pial, "--pial", "pial surface", 0);
        }
        if (!options.white.empty()) {
            images.brain.white =
                readCortex(run, options.white, "--white", "white surface", options.pial.size());
        }
    });
    run.model.pial = images.brain.pial;
    readSources(run);
    return boundariesIn(images, run, hooks);
}

std::vector<TriangleMesh> readSurfaces(BemRun& run) {
    const BemOptions& options = run.options;
    if (!options.volume.empty()) readMainImage(options.volume, "volume", run);
    std::vector<NamedMesh> files;
    for (const fs::path& path : options.surfaces) {
        const auto stated = statedFrame(options.inputCoordinates, files.size());
        files.push_back({path, readMesh(path, {.keepsFaults = true, .inputCoordinates = stated})});
        addWarnings(run.model.warnings, files.back().file.warnings, baseName(path));
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
        run.model.cortex =
            readCortex(run, options.sources, "--sources", "source surface",
                       options.surfaces.size() + options.pial.size() + options.white.size());
    });
}

void chooseTkRas(BemRun& run) {
    const BemOptions& options = run.options;
    if (!options.subject.empty()) {
        const fs::path subject = options.subjectsDir / options.subject;
        const fs::path orig = subject / "mri" / "orig.mgz";
        std::error_code error;
        if (fs::is_regular_file(orig, error)) {
            requireIn(orig, subject);
            run.model.tkRasVolume = readOnlyImage(orig).volume.view().geometry();
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
