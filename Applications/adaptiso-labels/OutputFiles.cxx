#include "OutputFiles.h"

#include <algorithm>
#include <charconv>

#include "Common/Numbers.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshIO/LabelFiles.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

constexpr std::string_view kVtp = ".vtp";

MeshWriteOptions writeOptions(const LabelsRun& run) {
    MeshWriteOptions write;
    write.frame = run.frame;
    write.volume = frameVolume(run.frame, run.map.geometry);
    return write;
}

void writeWalls(const LabelComplex& complex, const LabelsRun& run, AtomicFolder& folder) {
    MeshWriteOptions write = writeOptions(run);
    write.cellArrays = {{"label0", {}}, {"label1", {}}};
    for (std::size_t side = 0; side < 2; ++side) {
        std::vector<Label>& values = write.cellArrays[side].values;
        values.reserve(complex.labels.size());
        for (const auto& labels : complex.labels) values.push_back(labels[side]);
    }
    writeMesh({complex.points, {}, complex.triangles}, folder.place("walls.vtp"), write);
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

bool fits(const JoinedSurfaces& joined) {
    const auto most = static_cast<std::size_t>(findMeshFormat("all.surf.gii").maxElements);
    return joined.mesh.points.size() <= most && joined.mesh.triangles.size() <= most;
}

void writeJoined(const JoinedSurfaces& joined, LabelsRun& run, AtomicFolder& folder) {
    if (!fits(joined)) {
        run.warnings.push_back(
            "all.surf.gii is not written: the surfaces have more points than GIFTI counts");
        return;
    }
    writeMesh(joined.mesh, folder.place("all.surf.gii"), writeOptions(run));
    std::vector<LabelKey> table;
    for (const Region& region : run.regions) {
        table.push_back({region.label, region.name, region.color});
    }
    writeGiftiLabels(joined.labels, table, folder.place("all.label.gii"));
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
    constexpr std::string_view kNames[] = {"walls.vtp",     "all.vtm",     "all.surf.gii",
                                           "all.label.gii", "regions.tsv", "report.json"};
    return std::ranges::find(kNames, name) != std::end(kNames);
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
    folder.fill([&] {
        writeWalls(complex, run, folder);
        JoinedSurfaces joined;
        std::vector<VtkBlock> blocks;
        const bool areVtp = run.options.format == kVtp;
        for (std::size_t n = 0; n < run.regions.size(); ++n) {
            const Region& region = run.regions[n];
            const TriangleMesh surface = surfaces.surface(n);
            writeMesh(surface, folder.place(region.file), writeOptions(run));
            std::string block = region.file;
            if (!areVtp) {
                block = "all/" + std::to_string(region.label) + std::string(kVtp);
                writeMesh(surface, folder.place(block), writeOptions(run));
            }
            blocks.push_back({region.name, block});
            joined.add(surface, region.label);
        }
        writeMultiBlock(blocks, folder.place("all.vtm"));
        writeJoined(joined, run, folder);
        folder.writeText("regions.tsv", regionsTable(run));
    });
}

}  // namespace adaptiso
