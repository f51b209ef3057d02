#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "Common/AtomicOutput.h"
#include "LabelsRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {

/// The walls as OpenMEEG takes them: a mesh for each pair of labels that touch.
struct LayerMeshes {
    struct Wall {
        std::array<Label, 2> labels;  ///< normals point from the first into the second
        TriangleMesh mesh;            ///< open where it meets other walls
        std::string name() const;     ///< "wall_1_2"
    };
    std::vector<Wall> walls;  ///< by labels
};

LayerMeshes layerMeshes(const LabelComplex& complex);

/// Domain Description 1.1 with meshes and signed interfaces: the interface of a region is the sum
/// of its walls, facing outward; a domain lies inside its region's interface, Air outside of that
/// of all.
std::string layersGeometry(const LayerMeshes& meshes, const std::vector<Region>& regions);

/// S/m of each region, and 0 of Air. \pre each region has one
std::string layersConductivities(const std::vector<Region>& regions,
                                 const std::map<Label, double>& conductivities);

/// Places and writes layers/layers.geom, layers/layers.cond where conductivities were given, and a
/// .tri for each wall. \pre inside folder.fill()
void writeLayers(const LabelComplex& complex, const LabelsRun& run, AtomicFolder& folder);

/// "layers/wall_1_2.tri" and the other names that writeLayers() gives.
bool isLayerFile(std::string_view name);

}  // namespace adaptiso
