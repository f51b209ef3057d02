#include "OutputFiles.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <utility>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/LabelFiles.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso::labels {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kVtp = ".vtp";
constexpr const char* kMsh22Name = "tetrahedra.msh";
constexpr const char* kMsh41Name = "tetrahedra-4.1.msh";
constexpr const char* kVtuName = "tetrahedra.vtu";
constexpr const char* kDgfName = "tetrahedra.dgf";

MeshWriteOptions writeOptions(const LabelsRun& run) {
    MeshWriteOptions write;
    write.frame = run.frame;
    write.volume = frameVolume(run.frame, run.map.geometry);
    return write;
}

void writeWalls(const LabelComplex& complex, const fs::path& path, const LabelsRun& run) {
    MeshWriteOptions write = writeOptions(run);
    write.cellArrays = {{"label0", {}}, {"label1", {}}};
    for (std::size_t side = 0; side < 2; ++side) {
        std::vector<Label>& values = write.cellArrays[side].values;
        values.reserve(complex.labels.size());
        for (const auto& labels : complex.labels) values.push_back(labels[side]);
    }
    writeMesh({complex.points, {}, complex.triangles}, path, write);
}

/// The regions' surfaces in one mesh, vertices on walls once for each of their regions, and the
/// label of each vertex.
struct JoinedSurfaces {
    TriangleMesh mesh;
    std::vector<Label> labels;

    void add(const TriangleMesh& surface, Label label) {
        const auto before = static_cast<VertexId>(mesh.points.size());
        mesh.points.insert(mesh.points.end(), surface.points.begin(), surface.points.end());
        for (const Triangle& t : surface.triangles) {
            mesh.triangles.push_back({t[0] + before, t[1] + before, t[2] + before});
        }
        labels.resize(mesh.points.size(), label);
    }
};

void writeJoined(const RegionSurfaces& surfaces, const fs::path& surfacePath,
                 const fs::path& labelPath, const LabelsRun& run) {
    JoinedSurfaces joined;
    std::vector<LabelKey> table;
    for (std::size_t n = 0; n < run.regions.size(); ++n) {
        const Region& region = run.regions[n];
        joined.add(surfaces.surface(n), region.label);
        table.push_back({region.label, region.name, region.color});
    }
    writeMesh(joined.mesh, surfacePath, writeOptions(run));
    writeGiftiLabels(joined.labels, table, labelPath);
}

void writeTetrahedra(const LabelsRun& run, AtomicFolder& folder) {
    if (!run.tetrahedra) return;
    const AffineTransform move = lpsToFrame(run.frame, frameVolume(run.frame, run.map.geometry));
    const TetrahedralMesh mesh = transformed(run.tetrahedra->mesh, move.linear, move.offset);
    const std::vector<TetrahedraRegion>& regions = run.tetrahedra->regions;
    writeMsh22(mesh, regions, folder.place(kMsh22Name));
    writeMsh41(mesh, regions, folder.place(kMsh41Name));
    writeVtu(mesh, folder.place(kVtuName));
    writeDgf(mesh, regions, folder.place(kDgfName));
}

/// A field of a table: tabs and line ends would end it.
std::string field(const std::string& text) {
    return text.empty() ? "n/a" : text;
}

/// "12" of "12.vtp", when that is the name of a region's file.
bool isRegionFile(std::string_view name, bool isVtpOnly) {
    Label label = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), label);
    if (error != std::errc()) return false;
    const std::string_view extension = name.substr(static_cast<std::size_t>(end - name.data()));
    if (isVtpOnly) return extension == kVtp;
    return std::ranges::any_of(meshFormats(), [&](const MeshFormat& format) {
        return std::ranges::find(format.extensions, extension) != format.extensions.end();
    });
}

}  // namespace

bool isOwnFile(std::string_view name) {
    constexpr std::string_view kRegions = "regions/", kAll = "all/";
    if (name.starts_with(kRegions)) return isRegionFile(name.substr(kRegions.size()), false);
    if (name.starts_with(kAll)) return isRegionFile(name.substr(kAll.size()), true);
    if (isLayerFile(name)) return true;
    constexpr std::string_view kNames[] = {
        "walls.vtp",   "all.vtm",  "all.surf.gii", "all.label.gii", "regions.tsv",
        "report.json", kMsh22Name, kMsh41Name,     kVtuName,        kDgfName};
    return std::ranges::find(kNames, name) != std::end(kNames);
}

bool fitsGifti(const LabelsRun& run) {
    const auto most = static_cast<double>(findMeshFormat("all.surf.gii").maxElements);
    double points = 0, triangles = 0;
    for (const Region& region : run.regions) {
        points += static_cast<double>(region.measure.vertices);
        triangles += static_cast<double>(region.measure.triangles);
    }
    return points <= most && triangles <= most;
}

std::string regionsTable(const LabelsRun& run) {
    std::string text =
        "index\tname\tabbreviation\tcolor\tvoxels\tvolume_mm3\tarea_mm2\ttriangles\t"
        "euler_characteristic\tcomponents\tneighbours\n";
    for (const Region& region : run.regions) {
        const RegionMeasure& measure = region.measure;
        std::string neighbours;
        for (const RegionContact& contact : measure.neighbours) {
            neighbours += (neighbours.empty() ? "" : ",") + std::to_string(contact.label);
        }
        for (const std::string& each :
             {std::to_string(region.label), field(region.name), field(region.abbreviation),
              hexText(region.color), std::to_string(region.voxels), formatNumber(measure.volumeMm3),
              formatNumber(measure.areaMm2), std::to_string(measure.triangles),
              std::to_string(measure.eulerCharacteristic), std::to_string(measure.components)}) {
            text += each + '\t';
        }
        text += field(neighbours) + '\n';
    }
    return text;
}

void writeFiles(const LabelComplex& complex, const RegionSurfaces& surfaces, LabelsRun& run,
                AtomicFolder& folder) {
    const bool areVtp = run.options.format == kVtp;
    std::vector<std::function<void()>> works;  // the longest first
    const auto add = [&](auto&& work) { works.emplace_back(std::forward<decltype(work)>(work)); };
    folder.fill([&] {
        add([&, path = folder.place("walls.vtp")] { writeWalls(complex, path, run); });
        if (!run.leavesGiftiOut && fitsGifti(run)) {
            add([&, surface = folder.place("all.surf.gii"),
                 labels = folder.place("all.label.gii")] {
                writeJoined(surfaces, surface, labels, run);
            });
        }
        std::vector<VtkBlock> blocks;
        for (std::size_t n = 0; n < run.regions.size(); ++n) {
            const Region& region = run.regions[n];
            std::vector<fs::path> paths{folder.place(region.file)};
            blocks.push_back({region.name, region.file});
            if (!areVtp) {
                blocks.back().file = "all/" + std::to_string(region.label) + std::string(kVtp);
                paths.push_back(folder.place(blocks.back().file));
            }
            add([&, n, paths] {
                const TriangleMesh surface = surfaces.surface(n);
                for (const fs::path& path : paths) writeMesh(surface, path, writeOptions(run));
            });
        }
        if (run.options.writesLayers) writeLayers(complex, run, folder);
        writeMultiBlock(blocks, folder.place("all.vtm"));
        writeTetrahedra(run, folder);
        folder.writeText("regions.tsv", regionsTable(run));
        // VTK makes ready what all its writers share when the first of them is used: by one thread
        works.back()();
        works.pop_back();
        parallelForPieces(std::ssize(works), 1, [&](std::int64_t n, std::int64_t) { works[n](); });
    });
}

}  // namespace adaptiso::labels
