#include <algorithm>
#include <array>
#include <charconv>
#include <regex>

#include "OutputFiles.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::labels {
namespace {

constexpr std::string_view kFolder = "layers/";

std::string domainName(Label label) {
    return "Region" + std::to_string(label);
}

std::string shortest(double value) {
    std::array<char, 64> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
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
        text += domainName(region.label) + " " + shortest(conductivities.at(region.label)) + "\n";
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

}  // namespace adaptiso::labels
