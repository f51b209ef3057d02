#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/HeadModel/ConductivityModel.h"
#include "adaptiso/HeadModel/Finding.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadModel/Landmarks.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/HeadModel/Remesh.h"
#include "adaptiso/HeadModel/Seen.h"
#include "adaptiso/HeadModel/SegmentedSkull.h"
#include "adaptiso/HeadModel/SourceSpace.h"
#include "adaptiso/HeadModel/Tetrahedra.h"
#include "adaptiso/HeadPipeline/HeadNotes.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/MeshIO/PointFiles.h"
#include "adaptiso/MeshQuality/Shape.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso {

/// Electrodes to put on the skin of a model.
struct ElectrodeOptions {
    std::optional<CoordinateFrame> frame;  ///< of the file; else what it says, or by its landmarks
    std::string montage{};        ///< computed from landmarks, instead of a file's; empty: none
    bool wantsLandmarks = false;  ///< even without electrodes
};

/// Electrodes and landmarks that were given.
struct GivenElectrodes {
    std::optional<PointFile> file;       ///< as read
    std::string fileName;                ///< without folders
    std::optional<Landmarks> landmarks;  ///< LPS mm
};

/// Which places of dipoles to write for a lead field.
struct SourceOptions {
    std::int64_t count = 4098;       ///< sources of each surface of the cortex, at most
    std::optional<double> gridMm{};  ///< or a grid
};

/// Options of a head model, whatever it is made from.
struct BemModelOptions {
    BoundaryOptions boundaries;  ///< layers, gaps, thicknesses, isovalues
    /// One number for all surfaces or one for each; empty: by edge length or, without that, 2,562
    /// of each of three surfaces, and of more as many as the layers' thickness asks for, 10,000 in
    /// all at most.
    std::vector<std::int64_t> vertices;
    std::int64_t mostVertices = 10'000;  ///< of four or more in all, where no number is given
    std::optional<EdgeLengthRange> edgeLengthMm;
    ConductivityModel conductivities;
    std::size_t conductivitiesGiven = 0;
    ElectrodeOptions electrodes{};
    SourceOptions sources{};
    std::string leadField{};                      ///< by whom: "mne" or "openmeeg"; empty: none
    bool wantsHeadShape = false;                  ///< the skin alone as well, for coregistration
    std::vector<std::string> inputCoordinates{};  ///< as stated for files of surfaces, for reports

    /// Between neighbours, from inside out.
    std::vector<double> minGapsMm() const;
    std::optional<std::int64_t> verticesOf(std::size_t surface) const {
        if (vertices.empty()) return std::nullopt;
        return vertices.size() == 1 ? vertices.front() : vertices[surface];
    }
    std::size_t surfaceCount() const { return boundaries.surfaceCount(); }
    HeadSurface surface(std::size_t n) const { return headSurface(n, surfaceCount()); }
    bool hasSkin() const { return surfaceCount() > 1; }
};

/// The kind of input that a head model is made from.
enum class BemSource { T1, Labels, Probabilities, Ct, Surfaces };

/// "t1", "labels", "probabilities", "ct", "surfaces": the options of these names.
const char* toString(BemSource source);

/// An input of the model, for the reports.
struct BemInput {
    std::string file;    ///< without folders; empty: no file
    std::string role;    ///< "t1", "brain mask", "labels", ...
    std::string format;  ///< "NIfTI-1", "STL", ...
};

/// One surface, from dense to final.
struct BemSurface {
    std::int64_t denseTriangles = 0;  ///< 0: the surface was taken as it came
    /// Vertices of a ready surface that only needs other triangles, and as many.
    std::optional<std::int64_t> ownVertices;
    std::optional<MendStatistics> mending{};  ///< of a ready surface that was unsound; LPS mm
    std::optional<RemeshStatistics> remesh;
    SurfaceMove move;  ///< by nesting
    TopologyReport topology;
    ShapeReport shape;
    std::int64_t crossingPairs = 0;
    double areaMm2 = 0;
    double volumeMm3 = 0;
    double solidAngleShare = 0;
    Vec3 extentMm;
    std::optional<SeenSurface> seen{};     ///< of the final mesh; empty if not measured
    std::optional<double> segmentedMm3{};  ///< its volume in the segmentation
};

/// A promise about the model, kept or not.
struct BemCheck {
    std::string subject;  ///< "inner_skull", "inner_skull in outer_skull", "tetrahedra", a file
    std::string name;     ///< "one closed surface of genus 0"
    bool isPassed = false;
    std::string detail;
    std::optional<Vec3> pointMm;  ///< LPS, where it is not kept

    std::string fullName() const { return subject + ": " + name; }
};

/// The skin alone, for coregistration.
struct HeadShape {
    TriangleMesh dense;   ///< as finely as it was found
    TriangleMesh sparse;  ///< of the model, with at most 2,500 triangles
};

/// Digitized points of the scalp that electrodes were brought to the skin by.
struct HeadPoints {
    std::int64_t count = 0;
    SkinFit fit;
};

/// Electrodes and landmarks on a model's skin.
struct BemElectrodes {
    std::optional<Landmarks> landmarks;
    std::string landmarkOrigin;      ///< "given", "file" or "guessed"
    std::vector<NamedPoint> points;  ///< electrodes, LPS mm
    std::optional<HeadPoints> headPoints{};
    bool areComputed = false;  ///< by a system of positions, not from a file
    double meanMovedMm = 0, farthestMovedMm = 0;
    std::string farthestName;
    /// How far each may be off because landmarks were guessed; empty: none were.
    std::vector<double> uncertaintyMm{};

    /// Electrodes, and landmarks as they are.
    std::vector<NamedPoint> all() const;
};

/// Places of dipoles within a model.
struct BemSources {
    std::vector<SourceSpace> spaces;  ///< left hemisphere first; or one grid
    SourceMoves moves;

    std::int64_t count() const;
    std::int64_t dipoles() const;  ///< three at each point of a grid
};

/// Potentials at a model's electrodes of its dipoles.
struct BemLeadField {
    std::string solver;        ///< "MNE-Python 1.3.0"
    std::vector<double> gain;  ///< as LeadField has it, columns as dipoles.txt has lines
    std::string forward{};     ///< the bytes of MNE's own file; may be empty
};

/// Spongy bone within a model's skull.
struct BemSpongyBone {
    TriangleMesh mesh;  ///< closed, of any number of pieces; LPS mm
    std::int64_t pieces = 0;
    double volumeMm3 = 0;
    double segmentedMm3 = 0;                ///< of its labels
    double innerGapMm = 0, outerGapMm = 0;  ///< from inner and outer skull
};

/// The layers of a model in tetrahedra.
struct BemTetrahedra {
    std::string mesher;    ///< "tetgen" or "gmsh"
    TetrahedralMesh mesh;  ///< LPS mm
    TetrahedraReport report;
};

/// A head model, or what is known of it so far: what it is made from, its surfaces, whether they
/// keep what is promised of them.
struct BemModel {
    BemModelOptions options;
    BemSource source = BemSource::T1;
    std::vector<BemInput> inputs;
    std::vector<Warning> warnings;             ///< doubts about the result
    std::vector<std::string> notes;            ///< guesses, findings, changes
    std::optional<ImageGeometry> image;        ///< the main image's
    std::optional<ImageGeometry> tkRasVolume;  ///< whose tkRAS the FreeSurfer files are in
    std::string tkRasName;                     ///< of that volume, for the footer
    /// Inside out, LPS mm. Where there is no model: what it was tried from.
    std::vector<TriangleMesh> meshes;
    std::vector<BemSurface> surfaces;
    std::vector<std::vector<Vec3>> seenMm;  ///< as HeadBoundaries has it
    /// Surfaces that were given, where all are made anew, until the model is there.
    std::vector<TriangleMesh> given;
    std::optional<SegmentedHead> segmented;  ///< until there is a model; of a skull with holes on
    std::optional<SkullComparison> skull;    ///< of a model made from a segmentation
    std::optional<BemSpongyBone> spongyBone{};  ///< of labels that tell it apart
    std::optional<HeadShape> headShape;  ///< LPS mm; if wanted, and there is a model with a skin
    std::optional<BemTetrahedra> tetrahedra;  ///< if wanted, and there is a model
    std::optional<BemElectrodes> electrodes;  ///< if wanted, and there is a model
    std::optional<BemSources> sources{};      ///< if wanted, and there is a model
    std::optional<BemLeadField> leadField{};  ///< if wanted, and there is a model
    std::vector<TriangleMesh> pial{};         ///< LPS mm, as given: to lie within the inner skull
    GivenElectrodes givenElectrodes{};
    std::vector<TriangleMesh>
        cortex{};  ///< for sources, until they are placed; LPS mm, two at most
    std::vector<NestedGap> gaps;
    std::vector<BemCheck> checks;
    std::vector<ReportedNote> plausibility;  ///< unusual properties of the head
    std::vector<Finding> findings;           ///< why there is no model; points in LPS mm
    std::vector<Finding> doubts{};           ///< as HeadBoundaries has them
    std::vector<HeadFigure> figures{};       ///< as HeadBoundaries has them

    bool hasModel() const { return findings.empty(); }
    /// A failed check is a finding too. \pre one that failed has a point
    void addCheck(BemCheck check) {
        if (!check.isPassed) {
            findings.push_back({check.fullName() + ": " + check.detail, *check.pointMm});
        }
        checks.push_back(std::move(check));
    }
    bool wantsElectrodes() const {
        const ElectrodeOptions& wanted = options.electrodes;
        return givenElectrodes.file || givenElectrodes.landmarks || !wanted.montage.empty() ||
               wanted.wantsLandmarks;
    }

    /// Why there is no model and where, in one line; the point in scanner RAS, as viewers show it.
    /// \pre !hasModel()
    std::string failureText() const;
};

/// For those who show progress or measure time.
struct BemHooks {
    StageRunner runStage{};       ///< "extract", "remesh", ...; empty: work is called, that is all
    ProgressCallback progress{};  ///< as BoundaryOptions has it

    void stage(std::string_view name, const std::function<void()>& work) const {
        runStage ? runStage(name, work) : work();
    }
};

/// "(1.0, -2.0, 3.0) mm RAS" of a point in LPS mm.
std::string rasText(const Vec3& lps);

/// "inner_skull" of surface 0 of three.
std::string bemSurfaceName(std::size_t surface, std::size_t count);

}  // namespace adaptiso
