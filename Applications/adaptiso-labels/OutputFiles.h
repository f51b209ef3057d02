#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "Regions.h"
#include "Run.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::labels {

/// Moves single points of the walls to neighbouring coordinates, so that what is sound is so in
/// the files of the run as well, whose coordinates have fewer digits. All files have the same
/// points, so neighbours stay equal. all.surf.gii is left out, with a warning, where its digits do
/// not do.
/// \throws InvalidInput  those of the format that was asked for, or of the layers, do not
void fitToFiles(LabelComplex& complex, LabelsRun& run);

/// The walls with the digits of the regions' files; LPS mm.
LabelComplex asStored(const LabelComplex& complex, const LabelsRun& run);

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

/// Whether a name in an output folder is of a file that this program writes there.
bool isOwnFile(std::string_view name);

/// all.surf.gii can hold the regions' surfaces: GIFTI counts in 32 bits.
bool fitsGifti(const LabelsRun& run);

/// Writes all but report.json into the folder, and keeps the names in run.files:
///   walls.vtp             points once, label0 and label1 of each triangle
///   regions/<label>.<x>   the surface of each region
///   all.vtm               the regions as one VTK multiblock, with all/<label>.vtp where
///                         regions/<label>.<x> are no .vtp
///   all.surf.gii          the regions' surfaces as one, vertices on walls once for each region
///   all.label.gii         the label of each of its vertices, and the label table; neither where it
///                         does not fit
///   regions.tsv           a BIDS lookup table with measures
///   map.nii.gz            the map itself, where it is wanted
/// \param map  with merged labels
/// \throws FileError, InvalidInput  as writeMesh()
void writeFiles(const LabelComplex& complex, const RegionSurfaces& surfaces, const Volume& map,
                LabelsRun& run, AtomicFolder& folder);

/// From LPS mm to the files' coordinates, scaled.
AffineTransform toFile(const LabelsRun& run);

/// Writes the regions' surfaces, where it can with their names and colours, into the one file that
/// is the run's output (LabelsRun::isScene). \throws FileError, InvalidInput  as writeScene()
void writeSceneFile(const RegionSurfaces& surfaces, LabelsRun& run);

/// regions.tsv.
std::string regionsTable(const LabelsRun& run);

}  // namespace adaptiso::labels
