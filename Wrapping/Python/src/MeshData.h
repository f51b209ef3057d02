#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::python {

namespace py = pybind11;

/// Origin of an image, for reports.
struct ImageOrigin {
    std::string file;    ///< without folders; empty: an array
    std::string format;  ///< "NIfTI-1", "array", ...
    std::vector<Warning> warnings;
};

/// History of a surface, for the program's JSON report.
struct SurfaceHistory {
    SurfaceRecord record;
    ExtractionOptions extraction;  ///< without its callback
    IndexOptions index;
    std::size_t indexBytes = 0;
    ComponentSelection selection;
    ImageOrigin origin;
    PixelType pixelType{};
    ValueRange range{};
    PreprocessOptions preprocessing;
    std::optional<PreprocessedImage> preprocessed;
    std::vector<Warning> preprocessingWarnings;
    std::vector<Warning> warnings;  ///< of the surface
    int threads = 0;
    std::vector<std::pair<std::string, double>> seconds;
    double peakMemoryMb = 0;

    /// Of the values that the surface is made from.
    const ValueRange& workingRange() const { return preprocessed ? preprocessed->range : range; }
};

/// LPS to RAS and back.
void turnXY(std::vector<Vec3>& points);

/// A mesh whose arrays Python looks at. Points are in scanner RAS mm (or in `frame`): LPS with the
/// signs of x and y turned in place, which gives the very same numbers back when it is turned
/// again.
class MeshData {
public:
    /// \param mesh  LPS mm
    static std::shared_ptr<MeshData> fromLps(TriangleMesh mesh, std::optional<ImageGeometry> image,
                                             std::optional<SurfaceHistory> history);

    /// \param points   n x 3 \param faces  m x 3 \param normals  n x 3 or none; all are copied
    /// \param frame    of the points, "ras" or "tkras"
    /// \param image    that tkRAS and voxel indices refer to, or none
    /// \throws InvalidInput  shapes; unless `keepsFaults`: not finite, faces out of range
    static std::shared_ptr<MeshData> fromArrays(
        const py::array_t<double, py::array::c_style>& points,
        const py::array_t<std::int64_t, py::array::c_style>& faces,
        const std::optional<py::array_t<float, py::array::c_style>>& normals, CoordinateFrame frame,
        std::optional<ImageGeometry> image, bool keepsFaults);

    /// Points as they are, in `frame`.
    static MeshData asStored(TriangleMesh mesh, CoordinateFrame frame) {
        MeshData data;
        data.mesh_ = std::move(mesh);
        data.frame_ = frame;
        return data;
    }

    /// Points as they are, in this one's frame and of its image.
    std::shared_ptr<MeshData> alike(TriangleMesh mesh) const {
        auto data = std::make_shared<MeshData>(asStored(std::move(mesh), frame_));
        data->image_ = image_;
        data->isFrameKnown_ = isFrameKnown_;
        return data;
    }

    const TriangleMesh& mesh() const { return mesh_; }
    /// The surface with x and y turned, without normals: LPS mm of one in RAS.
    TriangleMesh lps() const;
    CoordinateFrame frame() const { return frame_; }
    /// Else it is of a file that does not say its frame: points as stored, frame() is Ras.
    bool isFrameKnown() const { return isFrameKnown_; }
    void setFrameKnown(bool isKnown) { isFrameKnown_ = isKnown; }
    const std::optional<ImageGeometry>& image() const { return image_; }
    void setImage(const ImageGeometry& image) { image_ = image; }
    /// MeshFile::solids of the file that it was read from.
    const std::vector<std::int64_t>& solids() const { return solids_; }
    void setSolids(std::vector<std::int64_t> solids) { solids_ = std::move(solids); }
    std::optional<double> errorBoundMm() const { return errorBoundMm_; }
    void setErrorBoundMm(std::optional<double> bound) { errorBoundMm_ = bound; }

    /// The report adaptiso-mesh/1, or "" of a mesh that was not made from an image.
    std::string report();
    /// Of the surface that was made from an image.
    std::vector<Warning> surfaceWarnings() const {
        std::vector<Warning> all;
        if (!history_) return all;
        addWarnings(all, history_->preprocessingWarnings);
        addWarnings(all, history_->warnings);
        return all;
    }
    void setReport(std::string report) { report_ = std::move(report); }

    /// The bound that the mesh was asked to keep, mm; none: none, or not known.
    void setRequestedBoundMm(std::optional<double> bound) { requestedBoundMm_ = bound; }

    /// Moved to where `transform` takes its points; the image is another's then.
    /// \throws InvalidInput  a point goes beyond what a double holds
    std::shared_ptr<MeshData> moved(const AffineTransform& transform) const;

    /// Writes a file, whole or not at all, in `frame` or in the format's own. Points of an unknown
    /// frame are written as they are, and the file says no frame.
    /// \param cellArrays  as MeshWriteOptions has them
    /// \return a warning, without the file's name: the format's digits take the file beyond the
    ///         bound that was asked for; else ""
    /// \throws InvalidInput  a frame that the format can't hold, or digits that do not do
    std::string write(const std::string& path, std::optional<CoordinateFrame> frame,
                      std::vector<CellArray> cellArrays = {}) const;

    /// The same in place.
    std::string writeTo(const std::filesystem::path& path, std::optional<CoordinateFrame> frame,
                        std::vector<CellArray> cellArrays) const;

    /// The mesh in the viewer of report pages, for a notebook. \pre it has triangles
    std::string notebook(const std::string& title) const;

    /// Draws it from the front into a PNG file, whole or not at all. \throws FileError
    void draw(const std::string& path) const;

private:
    bool isMade() const { return isMade_ || history_ || !report_.empty(); }

    TriangleMesh mesh_;
    CoordinateFrame frame_ = CoordinateFrame::Ras;
    bool isFrameKnown_ = true;
    std::optional<ImageGeometry> image_;
    std::vector<std::int64_t> solids_;
    std::optional<double> errorBoundMm_, requestedBoundMm_;
    std::optional<SurfaceHistory> history_;
    std::string report_;
    bool isMade_ = false;  ///< of one that was made here, so its files are as sound as it is
};

/// That `max_error` is large for the mesh's size, if it is. \param maxErrorMm  none: not given
std::vector<Warning> warningsOfBound(std::optional<double> maxErrorMm, const TriangleMesh& mesh);

/// Reads a surface file: points in scanner RAS mm where the file says how to get there, else in the
/// frame that it says, else as stored.
/// \param image        that tkRAS and voxel indices refer to, or none
/// \param keepsFaults  points as stored, with all that is wrong
/// \param stated       the frame, overriding the file's own; or none
/// \return the mesh, and the warnings of reading
/// \throws FileError, InvalidInput  voxel indices without an image; an image and no frame
std::pair<std::shared_ptr<MeshData>, std::vector<Warning>> readMeshData(
    const std::string& path, const std::optional<ImageGeometry>& image, bool keepsFaults,
    std::optional<CoordinateFrame> stated);

}  // namespace adaptiso::python
