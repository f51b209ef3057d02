#include "adaptiso/HeadPipeline/BemFiles.h"

#include <algorithm>
#include <utility>

#include "BemFileKinds.h"
#include "BemReadme.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/PointFiles.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr double kMetresPerMm = 0.001;

double unitOf(const BemFileOptions& options) {
    return options.unit == OpenMeegUnit::Metres ? kMetresPerMm : 1;
}

std::string numbersOf(const Vec3& v) {
    return formatFixed(v.x, 6) + " " + formatFixed(v.y, 6) + " " + formatFixed(v.z, 6);
}

/// The same move of points in metres.
AffineTransform inMetres(AffineTransform mm) {
    mm.offset = kMetresPerMm * mm.offset;
    return mm;
}

std::vector<NamedPoint> pointsIn(CoordinateFrame frame, const BemModel& model) {
    if (!model.electrodes) return {};
    std::vector<NamedPoint> points = model.electrodes->all();
    const AffineTransform move = lpsToFrame(frame, model.tkRasVolume);
    for (NamedPoint& p : points) p.point = move(p.point);
    return points;
}

void writeElectrodes(const BemModel& model, const BemFileOptions& options, const PlaceFile& place) {
    const std::vector<NamedPoint> points = pointsIn(options.frame, model);
    if (points.empty()) return;
    const fs::path tsv = place(kElectrodesTsv);
    writeBidsElectrodes(points, tsv, place(kElectrodesJson), options.frame);
    writeElc(points, place(kElectrodesElc));
    writeSfp(points, place(kElectrodesSfp));
    const CoordinateFrame mri = model.tkRasVolume ? CoordinateFrame::TkRas : CoordinateFrame::Ras;
    writeFiffPoints(pointsIn(mri, model), place(kElectrodesFif));
    if (model.electrodes->landmarks) {
        const AffineTransform toHead = toNeuromag(*model.electrodes->landmarks);
        writeFiffHeadToMri(inMetres(lpsToFrame(mri, model.tkRasVolume) * inverse(toHead)),
                           place(kHeadToMriFif));
    }
    if (model.electrodes->points.empty()) return;
    std::string lines;
    for (const NamedPoint& p : points) {
        if (p.kind == PointKind::Electrode) lines += numbersOf(unitOf(options) * p.point) + "\n";
    }
    writeText(place(kElectrodesTxt), lines);
}

void writeDipoles(const BemModel& model, const BemFileOptions& options, const PlaceFile& place) {
    const AffineTransform move = lpsToFrame(options.frame, model.tkRasVolume);
    std::string lines;
    for (const SourceSpace& space : model.sources->spaces) {
        for (const std::int64_t point : space.used) {
            const std::string at = numbersOf(unitOf(options) * move(space.surface.points[point]));
            for (const Vec3& direction : space.orientations(point)) {
                const Vec3 along = space.grid ? direction : move.linear * direction;
                lines += at + " " + numbersOf(along) + "\n";
            }
        }
    }
    writeText(place(kDipolesTxt), lines);
}

FiffSources::Grid gridIn(const ImageGeometry& grid, const AffineTransform& toMri,
                         const std::optional<ImageGeometry>& image) {
    const auto sizeOf = [](const ImageGeometry& geometry) {
        std::array<std::int32_t, 3> size{};
        std::copy(geometry.size.begin(), geometry.size.end(), size.begin());
        return size;
    };
    const auto placeOf = [&](const ImageGeometry& geometry) {
        AffineTransform place =
            toMri * AffineTransform{geometry.indexToPhysical, geometry.originMm};
        for (Vec3& column : place.linear.column) column = kMetresPerMm * column;
        return inMetres(place);
    };
    const ImageGeometry& parent = image ? *image : grid;
    const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, {}) * inverse(toMri);
    return {sizeOf(grid), sizeOf(parent), placeOf(grid), placeOf(parent), inMetres(toRas)};
}

void writeSources(const BemModel& model, const PlaceFile& place) {
    const CoordinateFrame mri = model.tkRasVolume ? CoordinateFrame::TkRas : CoordinateFrame::Ras;
    const AffineTransform toMri = lpsToFrame(mri, model.tkRasVolume);
    const double middleX = boundingBox(model.meshes.front()).middle().x;
    std::vector<FiffSources> spaces;
    for (const SourceSpace& space : model.sources->spaces) {
        FiffSources& written = spaces.emplace_back();
        written.mesh = transformed(space.surface, toMri);
        for (Vec3& p : written.mesh.points) p = kMetresPerMm * p;
        written.used = space.used;
        if (space.grid) {
            written.mesh.normals.assign(written.mesh.points.size(), Normal{0, 0, 1});
            written.grid = gridIn(*space.grid, toMri, model.tkRasVolume);
            continue;
        }
        const bool isRight = model.sources->spaces.size() == 2
                                 ? spaces.size() == 2
                                 : boundingBox(space.surface).middle().x < middleX;
        written.id = isRight ? FiffSources::kRightHemisphere : FiffSources::kLeftHemisphere;
    }
    writeFiffSources(spaces, place(kSourcesFif));
}

void writeTetrahedra(const BemModel& model, const BemFileOptions& options, const PlaceFile& place) {
    const AffineTransform move = lpsToFrame(options.frame, model.tkRasVolume);
    const TetrahedralMesh mesh = transformed(model.tetrahedra->mesh, move.linear, move.offset);
    const std::vector<TetrahedraRegion> regions = headRegions(model.meshes);
    writeMsh22(mesh, regions, place(kMsh22File), true);
    writeMsh41(mesh, regions, place(kMsh41File));
    writeVtu(mesh, place(kVtuFile));
    writeDgf(mesh, allTissues(), place(kDgfFile));
    std::string list;
    for (const double value : tissueConductivities(model.options.conductivities))
        list += formatNumber(value) + "\n";
    writeText(place(kTissueConductivitiesFile), list);
}

/// Landmarks first, as BESA wants them.
void writeBesa(const BemModel& model, const BemFileOptions& options, const PlaceFile& place) {
    std::vector<NamedPoint> points = pointsIn(options.frame, model);
    std::stable_partition(points.begin(), points.end(),
                          [](const NamedPoint& p) { return p.kind != PointKind::Electrode; });
    const AffineTransform move = lpsToFrame(options.frame, model.tkRasVolume);
    std::int64_t number = 0;
    for (const Vec3& p : model.meshes.back().points) {
        points.push_back({"S" + std::to_string(++number), PointKind::Other, move(p)});
    }
    writeSfp(points, place(kBesaFile));
}

}  // namespace

std::vector<std::string> bemFileNames() {
    std::vector<std::string> names{"model.geom",   "model.cond",    "report.json",
                                   "spots.png",    "README.md",     kFiffModel,
                                   kFiffDenseHead, kFiffSparseHead, kFieldTripFile,
                                   kElectrodesTsv, kElectrodesJson, kElectrodesElc,
                                   kElectrodesSfp, kElectrodesFif,  kElectrodesTxt,
                                   kBesaFile,      kMsh22File,      kMsh41File,
                                   kVtuFile,       kDgfFile,        kTissueConductivitiesFile,
                                   kDipolesTxt,    kSourcesFif,     kHeadToMriFif};
    for (std::size_t n = 0; n < kHeadSurfaceCount; ++n) {
        const HeadSurface surface = headSurface(n, kHeadSurfaceCount);
        for (const char* extension : {".surf", ".tri", ".gii", ".vtp"}) {
            names.push_back(bemFileName(surface, extension));
        }
        names.push_back(simNibsName(surface));
        names.push_back(brainstormName(surface));
    }
    return names;
}

std::string bemFileName(HeadSurface surface, const char* extension) {
    return std::string(toString(surface)) + extension;
}

void writeBemFiles(const BemModel& model, const BemFileOptions& options, const std::string& maker,
                   const std::function<fs::path(const std::string&)>& place) {
    std::vector<std::string> triangleFiles;
    for (std::size_t n = 0; n < model.meshes.size(); ++n) {
        triangleFiles.push_back(bemFileName(headSurface(n, model.meshes.size()), ".tri"));
    }
    for (const BemFileKind& kind : bemFileKinds(model, options)) kind.write(place);
    if (model.electrodes) writeElectrodes(model, options, place);
    if (model.sources) {
        writeDipoles(model, options, place);
        writeSources(model, place);
    }
    if (options.writesBesa) writeBesa(model, options, place);
    if (model.tetrahedra) writeTetrahedra(model, options, place);
    writeText(place("model.geom"), openMeegGeometry(triangleFiles));
    writeText(place("model.cond"),
              openMeegConductivities(model.meshes.size(), model.options.conductivities));
    writeText(place("README.md"), bemReadme(model, options, maker));
}

}  // namespace adaptiso
