#include "OutputFiles.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <regex>
#include <utility>

#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/ImageIO/WriteNifti.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/LabelFiles.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshIO/Scene.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso::labels {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kVtp = ".vtp";
constexpr const char* kMsh22Name = "tetrahedra.msh";
constexpr const char* kMsh41Name = "tetrahedra-4.1.msh";
constexpr const char* kVtuName = "tetrahedra.vtu";
constexpr const char* kDgfName = "tetrahedra.dgf";
constexpr const char* kMapName = "map.nii.gz";

MeshWriteOptions writeOptions(const LabelsRun& run) {
    MeshWriteOptions write;
    write.frame = run.frame;
    write.volume = frameVolume(run.frame, run.map.geometry);
    return write;
}

void writeWalls(const LabelComplex& complex, const fs::path& path, const LabelsRun& run) {
    MeshWriteOptions write = writeOptions(run);
    for (std::size_t side = 0; side < 2; ++side) {
        const auto valuesOf = [&]<class T>(T, const auto& valueOf) {
            std::vector<T> values;
            values.reserve(complex.labels.size());
            for (const auto& labels : complex.labels) values.push_back(valueOf(labels[side]));
            return values;
        };
        CellArray& array = write.cellArrays.emplace_back();
        array.name = side == 0 ? "label0" : "label1";
        if (!run.ids.areNumbered()) {
            array.values = valuesOf(Label{}, [](Label label) { return label; });
        } else if (run.map.pixelType == PixelType::Int64) {
            array.values = valuesOf(std::int64_t{}, [&](Label label) {
                return static_cast<std::int64_t>(run.ids.of(label).bits);
            });
        } else {
            array.values =
                valuesOf(std::uint64_t{}, [&](Label label) { return run.ids.of(label).bits; });
        }
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

/// "12" of "12.vtp", when that is the name of a region's file.
bool isRegionFile(std::string_view name, bool isVtpOnly) {
    LabelId id;
    std::string_view extension = name;
    if (!takeId(extension, id)) return false;
    if (isVtpOnly) return extension == kVtp;
    return std::ranges::any_of(meshFormats(), [&](const MeshFormat& format) {
        return std::ranges::find(format.extensions, extension) != format.extensions.end();
    });
}

constexpr std::string_view kFolder = "layers/";

std::string domainName(Label label) {
    return "Region" + std::to_string(label);
}

/// "Interface Region1: +wall_1_2 -wall_0_1": the walls of a label, outward of it or into it.
std::string interfaceLine(const LayerMeshes& meshes, const std::string& name, Label label,
                          bool isOutward) {
    std::string line = "Interface " + name + ":";
    for (const LayerMeshes::Wall& wall : meshes.walls) {
        if (wall.labels[0] != label && wall.labels[1] != label) continue;
        const bool isSame = (wall.labels[0] == label) == isOutward;
        line += (isSame ? " +" : " -") + wall.name();
    }
    return line + "\n";
}

}  // namespace

std::string LayerMeshes::Wall::name() const {
    return "wall_" + std::to_string(labels[0]) + "_" + std::to_string(labels[1]);
}

LayerMeshes layerMeshes(const LabelComplex& complex) {
    std::map<std::array<Label, 2>, std::vector<Triangle>> triangles;
    for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
        triangles[complex.labels[t]].push_back(complex.triangles[t]);
    }
    LayerMeshes meshes;
    for (auto& [labels, own] : triangles) {
        std::vector<VertexId> used;
        for (const Triangle& t : own) used.insert(used.end(), t.begin(), t.end());
        std::ranges::sort(used);
        used.erase(std::unique(used.begin(), used.end()), used.end());
        TriangleMesh mesh;
        for (const VertexId v : used) mesh.points.push_back(complex.points[v]);
        for (Triangle& t : own) {
            for (VertexId& v : t) v = std::ranges::lower_bound(used, v) - used.begin();
        }
        mesh.triangles = std::move(own);
        meshes.walls.push_back({labels, std::move(mesh)});
    }
    return meshes;
}

std::string layersGeometry(const LayerMeshes& meshes, const std::vector<Region>& regions) {
    std::string text =
        "# Domain Description 1.1\n\nMeshes " + std::to_string(meshes.walls.size()) + "\n\n";
    for (const LayerMeshes::Wall& wall : meshes.walls) {
        text += "Mesh " + wall.name() + ": \"" + wall.name() + ".tri\"\n";
    }
    text += "\nInterfaces " + std::to_string(regions.size() + 1) + "\n\n";
    for (const Region& region : regions) {
        text += interfaceLine(meshes, domainName(region.label), region.label, true);
    }
    text += interfaceLine(meshes, "Outside", 0, false);
    text += "\nDomains " + std::to_string(regions.size() + 1) + "\n\n";
    for (const Region& region : regions) {
        text += "Domain " + domainName(region.label) + ": -" + domainName(region.label) + "\n";
    }
    return text + "Domain Air: +Outside\n";
}

std::string layersConductivities(const std::vector<Region>& regions,
                                 const std::map<Label, double>& conductivities) {
    std::string text = "# Properties Description 1.0 (Conductivities)\n\n";
    for (const Region& region : regions) {
        text +=
            domainName(region.label) + " " + shortestText(conductivities.at(region.label)) + "\n";
    }
    return text + "Air 0\n";
}

void writeLayers(const LabelComplex& complex, const LabelsRun& run, AtomicFolder& folder) {
    const std::string prefix(kFolder);
    const LayerMeshes meshes = layerMeshes(complex);
    folder.writeText(prefix + "layers.geom", layersGeometry(meshes, run.regions));
    if (!run.options.conductivities.empty()) {
        folder.writeText(prefix + "layers.cond",
                         layersConductivities(run.regions, run.options.conductivities));
    }
    MeshWriteOptions write;
    write.frame = run.frame;
    write.volume = frameVolume(run.frame, run.map.geometry);
    for (const LayerMeshes::Wall& wall : meshes.walls) {
        writeMesh(wall.mesh, folder.place(prefix + wall.name() + ".tri"), write);
    }
}

bool isLayerFile(std::string_view name) {
    if (!name.starts_with(kFolder)) return false;
    static const std::regex own(R"(layers\.(geom|cond)|wall_-?\d+_-?\d+\.tri)");
    const std::string file(name.substr(kFolder.size()));
    return std::regex_match(file, own);
}

bool isOwnFile(std::string_view name) {
    constexpr std::string_view kRegions = "regions/", kAll = "all/";
    if (name.starts_with(kRegions)) return isRegionFile(name.substr(kRegions.size()), false);
    if (name.starts_with(kAll)) return isRegionFile(name.substr(kAll.size()), true);
    if (isLayerFile(name)) return true;
    constexpr std::string_view kNames[] = {
        "walls.vtp", "all.vtm",  "all.surf.gii", "all.label.gii", "regions.tsv", "report.json",
        kMsh22Name,  kMsh41Name, kVtuName,       kDgfName,        kMapName};
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
            addPart(neighbours, run.ids.text(contact.label), ",");
        }
        for (const std::string& each :
             {run.ids.text(region.label), writtenCell(region.name),
              writtenCell(region.abbreviation), hexText(region.color),
              std::to_string(region.voxels), formatNumber(measure.volumeMm3),
              formatNumber(measure.areaMm2), std::to_string(measure.triangles),
              std::to_string(measure.eulerCharacteristic), std::to_string(measure.components)}) {
            text += each + '\t';
        }
        text += writtenCell(neighbours) + '\n';
    }
    return text;
}

void writeSceneFile(const RegionSurfaces& surfaces, LabelsRun& run) {
    std::vector<ScenePart> parts;
    for (std::size_t n = 0; n < run.regions.size(); ++n) {
        const Region& region = run.regions[n];
        TriangleMesh surface = surfaces.surface(n);
        if (run.format->holdsNormals) surface.normals = areaWeightedNormals(surface);
        parts.push_back({region.name, region.color, std::move(surface)});
    }
    MeshWriteOptions write = writeOptions(run);
    if (run.scale != 1) {
        write.isInFrame = true;
        write.saysFrame = false;
        for (ScenePart& part : parts) part.mesh = transformed(part.mesh, toFile(run));
    }
    AtomicOutput& output = run.addOutput(run.folder);
    output.write([&](const fs::path& path) { writeScene(std::move(parts), path, write); });
    run.files = {{baseName(run.folder), fs::file_size(output.temporary())}};
}

void writeFiles(const LabelComplex& complex, const RegionSurfaces& surfaces, const Volume& map,
                LabelsRun& run, AtomicFolder& folder) {
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
        if (run.options.writesMap) {
            add([&, path = folder.place(kMapName)] { writeNifti(run.ids.withIds(map), path); });
        }
        std::vector<VtkBlock> blocks;
        for (std::size_t n = 0; n < run.regions.size(); ++n) {
            const Region& region = run.regions[n];
            std::vector<fs::path> paths{folder.place(region.file)};
            blocks.push_back({region.name, region.file});
            if (!areVtp) {
                blocks.back().file = "all/" + run.ids.text(region.label) + std::string(kVtp);
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
