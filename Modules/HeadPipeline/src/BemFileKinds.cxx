#include "BemFileKinds.h"

#include <algorithm>
#include <array>
#include <utility>

#include "adaptiso/HeadModel/ExportFreeSurfer.h"
#include "adaptiso/HeadModel/ExportMatlab.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr double kMetreMm = 1000;

/// Input of all kinds.
struct Source {
    const BemModel& model;
    const BemFileOptions& options;

    HeadSurface surface(std::size_t n) const { return headSurface(n, model.meshes.size()); }
    std::optional<ImageGeometry> volume(CoordinateFrame frame) const {
        return frame == CoordinateFrame::TkRas ? model.tkRasVolume : std::nullopt;
    }
    /// As FreeSurfer's files and MNE's have it.
    CoordinateFrame mriFrame() const {
        return model.tkRasVolume ? CoordinateFrame::TkRas : CoordinateFrame::Ras;
    }
    AffineTransform into(CoordinateFrame frame) const { return lpsToFrame(frame, volume(frame)); }
    /// Brainstorm's own coordinates follow from nasion and ears; guessed ones would not be its
    /// user's.
    bool knowsLandmarks() const {
        return model.electrodes && model.electrodes->landmarks &&
               !model.electrodes->landmarks->areGuessed();
    }
    /// Points moved, in units of `unitMm`, with normals.
    TriangleMesh placed(const TriangleMesh& mesh, const AffineTransform& move,
                        double unitMm) const {
        TriangleMesh moved = transformed(mesh, move);
        for (Vec3& point : moved.points) point = (1 / unitMm) * point;
        moved.normals = areaWeightedNormals(moved);
        return moved;
    }
    double conductivity(std::size_t n) const {
        return model.options.conductivities.within(surface(n), model.meshes.size());
    }
};

/// A kind that holds the whole model in a frame and a unit.
BemFileKind wholeModel(const Source& source, std::string name, const AffineTransform& fromLps,
                       double unitMm = 1) {
    BemFileKind kind{std::move(name), fromLps, unitMm, {}, {}, true, {}, {}};
    for (const TriangleMesh& mesh : source.model.meshes) kind.meshes.push_back(&mesh);
    kind.gapsMm = source.model.options.minGapsMm();
    return kind;
}

using WriteSurface =
    std::function<void(std::size_t n, const TriangleMesh& mesh, const fs::path& path)>;
using ReadSurface = std::function<TriangleMesh(const fs::path& path)>;

TriangleMesh readOne(const fs::path& path) {
    return readMesh(path).mesh;
}

/// A file for each surface.
BemFileKind oneEach(BemFileKind kind, const std::vector<std::string>& names,
                    const WriteSurface& write, const ReadSurface& read = readOne) {
    kind.write = [meshes = kind.meshes, names, write](const PlaceFile& place) {
        for (std::size_t n = 0; n < meshes.size(); ++n) write(n, *meshes[n], place(names[n]));
    };
    kind.read = [names, read](const fs::path& folder) {
        std::vector<TriangleMesh> stored;
        for (const std::string& name : names) stored.push_back(read(folder / name));
        return stored;
    };
    return kind;
}

/// "inner_skull.surf", ... of all surfaces.
std::vector<std::string> namesOf(const Source& source, const char* extension) {
    std::vector<std::string> names;
    for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
        names.push_back(bemFileName(source.surface(n), extension));
    }
    return names;
}

BemFileKind freeSurferFiles(const Source& source) {
    return oneEach(
        wholeModel(source, "*.surf", source.into(source.mriFrame())), namesOf(source, ".surf"),
        [source](std::size_t, const TriangleMesh& mesh, const fs::path& path) {
            writeFreeSurferSurface(mesh, path, source.model.tkRasVolume, source.model.tkRasName);
        });
}

BemFileKind openMeegFiles(const Source& source) {
    const BemFileOptions& options = source.options;
    const double unitMm = options.unit == OpenMeegUnit::Metres ? kMetreMm : 1;
    return oneEach(wholeModel(source, "*.tri", source.into(options.frame), unitMm),
                   namesOf(source, ".tri"),
                   [source](std::size_t, const TriangleMesh& mesh, const fs::path& path) {
                       writeOpenMeegSurface(mesh, path, source.options.frame, source.options.unit,
                                            source.volume(source.options.frame));
                   });
}

/// .gii and .vtp
BemFileKind viewerFiles(const Source& source, const char* extension) {
    return oneEach(
        wholeModel(source, std::string("*") + extension, source.into(source.options.frame)),
        namesOf(source, extension),
        [source](std::size_t, const TriangleMesh& mesh, const fs::path& path) {
            MeshWriteOptions write;
            write.frame = source.options.frame;
            write.volume = source.volume(write.frame);
            writeMesh(mesh, path, write);
        });
}

/// SimNIBS's own frame is the scanner's.
BemFileKind simNibsFiles(const Source& source) {
    std::vector<std::string> names;
    for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
        names.push_back(simNibsName(source.surface(n)));
    }
    return oneEach(
        wholeModel(source, "*.stl", source.into(CoordinateFrame::Ras)), names,
        [](std::size_t, const TriangleMesh& mesh, const fs::path& path) { writeMesh(mesh, path); });
}

/// In Brainstorm's own coordinates where they are known, else in the scanner's.
BemFileKind brainstormFiles(const Source& source) {
    std::vector<std::string> names;
    for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
        names.push_back(brainstormName(source.surface(n)));
    }
    const bool isScs = source.knowsLandmarks();
    const AffineTransform move = isScs ? toBrainstorm(*source.model.electrodes->landmarks)
                                       : source.into(CoordinateFrame::Ras);
    return oneEach(
        wholeModel(source, "tess_*_bem.mat", move, kMetreMm), names,
        [source, move, isScs](std::size_t n, const TriangleMesh& mesh, const fs::path& path) {
            writeBrainstormSurface(source.placed(mesh, move, kMetreMm), path,
                                   std::string(toString(source.surface(n))) +
                                       (isScs ? " (SCS, m)" : " (world: scanner RAS, m; not SCS)"));
        },
        readBrainstormSurface);
}

BemFileKind fieldTripFile(const Source& source) {
    BemFileKind kind = wholeModel(source, kFieldTripFile, source.into(source.options.frame));
    kind.write = [source](const PlaceFile& place) {
        std::vector<HeadLayer> layers;
        const CoordinateFrame frame = source.options.frame;
        for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
            layers.push_back({source.surface(n), source.conductivity(n),
                              source.placed(source.model.meshes[n], source.into(frame), 1)});
        }
        writeFieldTripModel(layers, place(kFieldTripFile), frame);
    };
    kind.read = [](const fs::path& folder) {
        std::vector<TriangleMesh> stored;
        for (HeadLayer& layer : readFieldTripModel(folder / kFieldTripFile)) {
            stored.push_back(std::move(layer.mesh));
        }
        return stored;
    };
    return kind;
}

/// FIFF's number of a surface.
std::int32_t fiffId(HeadSurface surface) {
    constexpr std::int32_t kBrain = 1, kSkull = 3, kHead = 4;
    return surface == HeadSurface::InnerSkull   ? kBrain
           : surface == HeadSurface::OuterSkull ? kSkull
                                                : kHead;
}

std::vector<TriangleMesh> readFiffMeshes(const fs::path& path) {
    std::vector<TriangleMesh> stored;
    for (FiffSurface& surface : readFiffSurfaces(path)) stored.push_back(std::move(surface.mesh));
    std::reverse(stored.begin(), stored.end());
    return stored;
}

/// Outermost first, as MNE writes them. MNE has no number for a brain within CSF: it gets the rest,
/// with the brain's conductivity within the inner skull.
BemFileKind fiffModel(const Source& source) {
    BemFileKind kind = wholeModel(source, kFiffModel, source.into(source.mriFrame()), kMetreMm);
    const std::size_t first = source.model.options.boundaries.withBrain ? 1 : 0;
    if (first > 0) {
        kind.meshes.erase(kind.meshes.begin());
        kind.gapsMm.erase(kind.gapsMm.begin());
    }
    kind.write = [source, first](const PlaceFile& place) {
        std::vector<FiffSurface> surfaces;
        for (std::size_t n = source.model.meshes.size(); n-- > first;) {
            surfaces.push_back(
                {fiffId(source.surface(n)),
                 n == first ? source.model.options.conductivities.brain : source.conductivity(n),
                 source.placed(source.model.meshes[n], source.into(source.mriFrame()), kMetreMm)});
        }
        writeFiffSurfaces(surfaces, place(kFiffModel));
    };
    kind.read = [](const fs::path& folder) { return readFiffMeshes(folder / kFiffModel); };
    return kind;
}

BemFileKind fiffHead(const Source& source, const char* name, const TriangleMesh& head) {
    BemFileKind kind{name, source.into(source.mriFrame()), kMetreMm, {&head}, {}, false, {}, {}};
    kind.write = [source, name, &head](const PlaceFile& place) {
        const FiffSurface surface{fiffId(HeadSurface::OuterSkin), 1.0,
                                  source.placed(head, source.into(source.mriFrame()), kMetreMm)};
        writeFiffSurfaces({&surface, 1}, place(name));
    };
    kind.read = [name](const fs::path& folder) { return readFiffMeshes(folder / name); };
    return kind;
}

}  // namespace

std::string simNibsName(HeadSurface surface) {
    constexpr std::array<const char*, kHeadSurfaceCount> kNames{"gm.stl", "csf.stl", "bone.stl",
                                                                "skin.stl"};
    return kNames[static_cast<std::size_t>(surface)];
}

std::string brainstormName(HeadSurface surface) {
    constexpr std::array<const char*, kHeadSurfaceCount> kNames{
        "tess_brain_bem.mat", "tess_innerskull_bem.mat", "tess_outerskull_bem.mat",
        "tess_head_bem.mat"};
    return kNames[static_cast<std::size_t>(surface)];
}

std::vector<BemFileKind> bemFileKinds(const BemModel& model, const BemFileOptions& options) {
    const Source source{model, options};
    std::vector<BemFileKind> kinds{freeSurferFiles(source), openMeegFiles(source)};
    if (options.writesGifti) kinds.push_back(viewerFiles(source, ".gii"));
    if (options.writesVtp) kinds.push_back(viewerFiles(source, ".vtp"));
    if (options.writesFif) kinds.push_back(fiffModel(source));
    if (options.writesFif && model.headShape) {
        kinds.push_back(fiffHead(source, kFiffDenseHead, model.headShape->dense));
        kinds.push_back(fiffHead(source, kFiffSparseHead, model.headShape->sparse));
    }
    if (options.writesFieldTrip) kinds.push_back(fieldTripFile(source));
    if (options.writesBrainstorm) kinds.push_back(brainstormFiles(source));
    if (options.writesSimNibs) kinds.push_back(simNibsFiles(source));
    return kinds;
}

}  // namespace adaptiso
