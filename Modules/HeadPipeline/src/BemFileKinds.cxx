#include "BemFileKinds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/ExportFreeSurfer.h"
#include "adaptiso/HeadModel/ExportMatlab.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/HeadPipeline/BemChecks.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr double kMetreMm = 1000;

using Files = std::vector<std::string>;
using Source = BemFileSource;

/// Brainstorm's own coordinates follow from nasion and ears; guessed ones would not be its user's.
bool knowsLandmarks(const Source& source) {
    return source.hasLandmarks() && !source.model.electrodes->landmarks->areGuessed();
}

/// Points moved, in units of `unitMm`, with normals.
TriangleMesh placed(const TriangleMesh& mesh, const AffineTransform& move, double unitMm) {
    TriangleMesh moved = transformed(mesh, move);
    for (Vec3& point : moved.points) point = (1 / unitMm) * point;
    moved.normals = areaWeightedNormals(moved);
    return moved;
}

/// How files of one format hold surfaces.
struct StoredSurfaces {
    AffineTransform fromLps;                    ///< of the points stored
    double unitMm = 1;                          ///< the same
    std::vector<const TriangleMesh*> meshes{};  ///< from inside out
    std::vector<double> gapsMm{};               ///< promised between these
    bool keepsPromises = true;  ///< they are the model's, not just pictures of the head
};

/// The whole model.
StoredSurfaces wholeModel(const Source& source, const AffineTransform& fromLps, double unitMm = 1) {
    StoredSurfaces held{fromLps, unitMm};
    for (const TriangleMesh& mesh : source.model.meshes) held.meshes.push_back(&mesh);
    held.gapsMm = source.model.options.minGapsMm();
    return held;
}

/// Between corners of the same triangles: STL files number vertices anew.
double farthestMm(const TriangleMesh& a, const TriangleMesh& b) {
    if (a.points.size() != b.points.size() || a.triangles.size() != b.triangles.size()) {
        return std::numeric_limits<double>::infinity();
    }
    double farthest = 0;
    for (std::size_t t = 0; t < a.triangles.size(); ++t) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const double mm =
                norm(a.points[a.triangles[t][corner]] - b.points[b.triangles[t][corner]]);
            if (!(mm <= farthest)) farthest = mm;
        }
    }
    return farthest;
}

/// The surfaces lie where they should, and keep what checkModel() promises of them.
/// \param stored  in the file's coordinates
BemFileFault checkSurfaces(const Source& source, const StoredSurfaces& held,
                           const std::vector<TriangleMesh>& stored) {
    const AffineTransform toLps = inverse(held.fromLps);
    std::vector<TriangleMesh> inMm = stored;
    double farthest =
        stored.size() == held.meshes.size() ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < inMm.size() && farthest <= kFileRoundingMm; ++n) {
        for (Vec3& p : inMm[n].points) p = held.unitMm * p;
        farthest = std::max(farthest, farthestMm(transformed(inMm[n], toLps), *held.meshes[n]));
    }
    if (!(farthest <= kFileRoundingMm)) {
        return source.fault("a vertex lies " + formatNumber(farthest) + " mm from where it should");
    }
    // to the bit as checkModel() found them, in its frame
    if (!held.keepsPromises || (farthest == 0 && held.unitMm == 1)) return std::nullopt;
    for (const ModelCheck& each : checkHeadSurfaces(inMm, held.gapsMm).checks) {
        if (!each.check.breaksProfile()) continue;
        return Finding{each.subject + ": " + std::string(each.check.name) + ": " +
                           each.check.finding + " (in the file's coordinates)",
                       toLps(each.pointMm)};
    }
    return std::nullopt;
}

/// Files of the model's surfaces, of those of all.
Files ofSurfaces(const Source& source, const Files& files) {
    Files names;
    for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
        names.push_back(files[static_cast<std::size_t>(source.surface(n))]);
    }
    return names;
}

using WriteSurface =
    std::function<void(std::size_t n, const TriangleMesh& mesh, const fs::path& path)>;

TriangleMesh readOne(const fs::path& path) {
    return readMesh(path).mesh;
}

/// A file for each surface of the model.
BemFileKind oneEach(const Source& source, const Files& files, const StoredSurfaces& held,
                    const WriteSurface& write, TriangleMesh (*read)(const fs::path&) = readOne) {
    const Files names = ofSurfaces(source, files);
    return {[=](const PlaceFile& place) {
                for (std::size_t n = 0; n < names.size(); ++n) {
                    write(n, *held.meshes[n], place(names[n]));
                }
            },
            [=](const fs::path& folder) {
                std::vector<TriangleMesh> stored;
                for (const std::string& name : names) stored.push_back(read(folder / name));
                return checkSurfaces(source, held, stored);
            }};
}

/// One file for all.
BemFileKind allInOne(const Source& source, const Files& files, const StoredSurfaces& held,
                     const std::function<void(const fs::path&)>& write,
                     std::vector<TriangleMesh> (*read)(const fs::path&)) {
    return {[=](const PlaceFile& place) { write(place(files.front())); },
            [=](const fs::path& folder) {
                return checkSurfaces(source, held, read(folder / files.front()));
            }};
}

BemFileKind freeSurferFiles(const Source& source, const Files& files) {
    return oneEach(source, files, wholeModel(source, source.into(source.mriFrame())),
                   [source](std::size_t, const TriangleMesh& mesh, const fs::path& path) {
                       writeFreeSurferSurface(mesh, path, source.model.tkRasVolume,
                                              source.model.tkRasName);
                   });
}

BemFileKind openMeegFiles(const Source& source, const Files& files) {
    const BemFileOptions& options = source.options;
    const double unitMm = options.unit == OpenMeegUnit::Metres ? kMetreMm : 1;
    return oneEach(source, files, wholeModel(source, source.into(options.frame), unitMm),
                   [source](std::size_t, const TriangleMesh& mesh, const fs::path& path) {
                       writeOpenMeegSurface(mesh, path, source.options.frame, source.options.unit,
                                            source.volume(source.options.frame));
                   });
}

/// .gii and .vtp
BemFileKind viewerFiles(const Source& source, const Files& files) {
    return oneEach(source, files, wholeModel(source, source.into(source.options.frame)),
                   [source](std::size_t, const TriangleMesh& mesh, const fs::path& path) {
                       MeshWriteOptions write;
                       write.frame = source.options.frame;
                       write.volume = source.volume(write.frame);
                       writeMesh(mesh, path, write);
                   });
}

/// SimNIBS's own frame is the scanner's.
BemFileKind simNibsFiles(const Source& source, const Files& files) {
    return oneEach(
        source, files, wholeModel(source, source.into(CoordinateFrame::Ras)),
        [](std::size_t, const TriangleMesh& mesh, const fs::path& path) { writeMesh(mesh, path); });
}

/// In Brainstorm's own coordinates where they are known, else in the scanner's.
BemFileKind brainstormFiles(const Source& source, const Files& files) {
    const bool isScs = knowsLandmarks(source);
    const AffineTransform move = isScs ? toBrainstorm(*source.model.electrodes->landmarks)
                                       : source.into(CoordinateFrame::Ras);
    return oneEach(
        source, files, wholeModel(source, move, kMetreMm),
        [source, move, isScs](std::size_t n, const TriangleMesh& mesh, const fs::path& path) {
            writeBrainstormSurface(placed(mesh, move, kMetreMm), path,
                                   std::string(toString(source.surface(n))) +
                                       (isScs ? " (SCS, m)" : " (world: scanner RAS, m; not SCS)"));
        },
        readBrainstormSurface);
}

BemFileKind fieldTripFile(const Source& source, const Files& files) {
    const CoordinateFrame frame = source.options.frame;
    return allInOne(
        source, files, wholeModel(source, source.into(frame)),
        [source, frame](const fs::path& path) {
            std::vector<HeadLayer> layers;
            for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
                layers.push_back({source.surface(n), source.conductivity(n),
                                  placed(source.model.meshes[n], source.into(frame), 1)});
            }
            writeFieldTripModel(layers, path, frame);
        },
        [](const fs::path& path) {
            std::vector<TriangleMesh> stored;
            for (HeadLayer& layer : readFieldTripModel(path)) {
                stored.push_back(std::move(layer.mesh));
            }
            return stored;
        });
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

/// Outermost first, as MNE writes them. MNE has no number for a brain within CSF: it gets the outer
/// three, with the brain's conductivity within the inner skull.
BemFileKind fiffModel(const Source& source, const Files& files) {
    const AffineTransform move = source.into(source.mriFrame());
    StoredSurfaces held = wholeModel(source, move, kMetreMm);
    const std::size_t first = source.model.options.boundaries.innerSurfaces;
    held.meshes.erase(held.meshes.begin(),
                      held.meshes.begin() + static_cast<std::ptrdiff_t>(first));
    held.gapsMm.erase(held.gapsMm.begin(),
                      held.gapsMm.begin() + static_cast<std::ptrdiff_t>(first));
    return allInOne(
        source, files, held,
        [source, first, move](const fs::path& path) {
            std::vector<FiffSurface> surfaces;
            for (std::size_t n = source.model.meshes.size(); n-- > first;) {
                surfaces.push_back({fiffId(source.surface(n)),
                                    n == first ? source.model.options.conductivities.brain
                                               : source.conductivity(n),
                                    placed(source.model.meshes[n], move, kMetreMm)});
            }
            writeFiffSurfaces(surfaces, path);
        },
        readFiffMeshes);
}

BemFileKind fiffHead(const Source& source, const Files& files, const TriangleMesh& head) {
    const AffineTransform move = source.into(source.mriFrame());
    return allInOne(
        source, files, {move, kMetreMm, {&head}, {}, false},
        [move, &head](const fs::path& path) {
            const FiffSurface surface{fiffId(HeadSurface::OuterSkin), 1.0,
                                      placed(head, move, kMetreMm)};
            writeFiffSurfaces({&surface, 1}, path);
        },
        readFiffMeshes);
}

/// OpenMEEG's .geom and .cond. Its reader checks every rule of theirs.
BemFileKind openMeegModel(const Source& source, const Files& files) {
    return {
        [=](const PlaceFile& place) {
            Files surfaces;
            for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
                surfaces.push_back(bemFileName(source.surface(n), ".tri"));
            }
            writeText(place(files[0]), openMeegGeometry(surfaces));
            writeText(place(files[1]), openMeegConductivities(source.model.meshes.size(),
                                                              source.model.options.conductivities));
        },
        [=](const fs::path& folder) -> BemFileFault {
            const OpenMeegModel stored = readOpenMeegModel(folder / files[0], folder / files[1]);
            for (std::size_t n = 0; n < source.model.meshes.size(); ++n) {
                constexpr double kDigits = 1e-6;
                const OpenMeegDomain& domain = stored.domains[n];
                if (std::abs(domain.conductivity - source.conductivity(n)) <= kDigits) continue;
                return source.fault("the conductivity of " + domain.name + " is " +
                                    formatNumber(domain.conductivity) + " S/m, must be " +
                                    formatNumber(source.conductivity(n)));
            }
            return std::nullopt;
        }};
}

Files filesOf(const char* extension) {
    Files names;
    for (std::size_t n = 0; n < kHeadSurfaceCount; ++n) {
        names.push_back(bemFileName(headSurface(n, kHeadSurfaceCount), extension));
    }
    return names;
}

bool hasSpongyBone(const Source& source) {
    return source.model.spongyBone.has_value();
}

/// Spongy bone, which may be in pieces.
BemFileKind spongyFile(const Source& source, const Files& files, CoordinateFrame frame) {
    const TriangleMesh& mesh = source.model.spongyBone->mesh;
    const StoredSurfaces held{source.into(frame), 1, {&mesh}, {}, false};
    return {[=, &mesh](const PlaceFile& place) {
                if (files.front() == kSpongyBoneSurf) {
                    writeFreeSurferSurface(mesh, place(files.front()), source.model.tkRasVolume,
                                           source.model.tkRasName);
                    return;
                }
                MeshWriteOptions write;
                write.frame = frame;
                write.volume = source.volume(frame);
                writeMesh(mesh, place(files.front()), write);
            },
            [=](const fs::path& folder) -> BemFileFault {
                const std::vector<TriangleMesh> stored{readOne(folder / files.front())};
                if (const BemFileFault moved = checkSurfaces(source, held, stored)) return moved;
                const SurfaceFacts facts =
                    measureSurface(stored.front(), sizeLimitsOf(Profile::Print), 1);
                for (const Check& check : judgeSurface(facts, {})) {
                    if (!check.breaksProfile()) continue;
                    return source.fault(std::string(check.name) + ": " + check.finding +
                                        " (in the file's coordinates)");
                }
                return std::nullopt;
            }};
}

std::vector<BemFileRow> allRows() {
    constexpr auto kAlways = [](const Source&) { return true; };
    constexpr auto kWithHead = [](const Source& s) {
        return s.options.writesFif && s.model.headShape.has_value();
    };
    std::vector<BemFileRow> rows{
        {"*.surf", filesOf(".surf"), kAlways, freeSurferFiles},
        {"*.tri", filesOf(".tri"), kAlways, openMeegFiles},
        {"*.gii", filesOf(".gii"), [](const Source& s) { return s.options.writesGifti; },
         viewerFiles},
        {"*.vtp", filesOf(".vtp"), [](const Source& s) { return s.options.writesVtp; },
         viewerFiles},
        {kFiffModel, {kFiffModel}, [](const Source& s) { return s.options.writesFif; }, fiffModel},
        {kFiffDenseHead,
         {kFiffDenseHead},
         kWithHead,
         [](const Source& s, const Files& files) {
             return fiffHead(s, files, s.model.headShape->dense);
         }},
        {kFiffSparseHead,
         {kFiffSparseHead},
         kWithHead,
         [](const Source& s, const Files& files) {
             return fiffHead(s, files, s.model.headShape->sparse);
         }},
        {"headmodel.mat",
         {"headmodel.mat"},
         [](const Source& s) { return s.options.writesFieldTrip || s.options.writesBemFmm; },
         fieldTripFile},
        {"tess_*_bem.mat",
         {"tess_white_bem.mat", "tess_brain_bem.mat", "tess_innerskull_bem.mat",
          "tess_outerskull_bem.mat", "tess_head_bem.mat"},
         [](const Source& s) { return s.options.writesBrainstorm; },
         brainstormFiles},
        {"*.stl", stlFileNames(), [](const Source& s) { return s.options.writesStl(); },
         simNibsFiles},
        {kSpongyBoneSurf,
         {kSpongyBoneSurf},
         hasSpongyBone,
         [](const Source& s, const Files& files) { return spongyFile(s, files, s.mriFrame()); }},
        {"spongy_bone.gii",
         {"spongy_bone.gii"},
         [](const Source& s) { return s.options.writesGifti && hasSpongyBone(s); },
         [](const Source& s, const Files& files) { return spongyFile(s, files, s.options.frame); }},
        {"spongy_bone.vtp",
         {"spongy_bone.vtp"},
         [](const Source& s) { return s.options.writesVtp && hasSpongyBone(s); },
         [](const Source& s, const Files& files) { return spongyFile(s, files, s.options.frame); }},
        {kSpongyStl,
         {kSpongyStl},
         [](const Source& s) { return s.options.writesStl() && hasSpongyBone(s); },
         [](const Source& s, const Files& files) {
             return spongyFile(s, files, CoordinateFrame::Ras);
         }}};
    for (BemFileRow& row : pointFileRows()) rows.push_back(std::move(row));
    rows.push_back({"model.geom, model.cond",
                    {"model.geom", "model.cond"},
                    kAlways,
                    openMeegModel,
                    "keep OpenMEEG's rules"});
    return rows;
}

}  // namespace

std::vector<std::string> stlFileNames() {
    return {"wm.stl", "gm.stl", "csf.stl", "bone.stl", "skin.stl"};
}

const std::vector<BemFileRow>& bemFileRows() {
    static const std::vector<BemFileRow> rows = allRows();
    return rows;
}

}  // namespace adaptiso
