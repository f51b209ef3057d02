// GIFTI 1.0 (www.nitrc.org/projects/gifti): POINTSET float32 and TRIANGLE int32, both
// GZipBase64Binary. No third array for normals: Connectome Workbench takes surface files of
// exactly two (SurfaceFile::validateDataArraysAfterReading).
//
// Debian's libgiftiio allocates what a header claims before it looks at the data, so it is not
// for files from outside; expat and zlib, which it rests on too, are used directly.
#include <vector>

#include "Codecs.h"
#include "GiftiArrays.h"
#include "adaptiso/MeshIO/FrameTransform.h"

namespace adaptiso::meshio {
namespace {

constexpr std::string_view kScannerSpace = "NIFTI_XFORM_SCANNER_ANAT";
constexpr std::string_view kUnknownSpace = "NIFTI_XFORM_UNKNOWN";
constexpr std::string_view kFrameKey = "CoordinateFrame";

void encodeMatrixRow(const AffineTransform& transform, int row, ByteSink& sink) {
    for (const Vec3& column : transform.linear.column) sink << column[row] << " ";
    sink << transform.offset[row] << "\n";
}

/// From the frame of the points to scanner RAS, as NIFTI-style tools expect to find it; nothing
/// where that is not known.
void encodeCoordinateSystem(const MeshWriteOptions& options, ByteSink& sink) {
    const bool isRas = options.frame == CoordinateFrame::Ras;
    const bool needsVolume =
        options.frame == CoordinateFrame::TkRas || options.frame == CoordinateFrame::Voxel;
    if (!options.saysFrame || (needsVolume && !options.volume)) return;
    const AffineTransform toRas = isRas ? AffineTransform{}
                                        : lpsToFrame(CoordinateFrame::Ras, std::nullopt) *
                                              inverse(lpsToFrame(options.frame, options.volume));
    sink << "<CoordinateSystemTransformMatrix>\n<DataSpace><![CDATA["
         << (isRas ? kScannerSpace : kUnknownSpace)
         << "]]></DataSpace>\n<TransformedSpace><![CDATA[" << kScannerSpace
         << "]]></TransformedSpace>\n<MatrixData>\n";
    for (int row = 0; row < 3; ++row) encodeMatrixRow(toRas, row, sink);
    sink << "0 0 0 1\n</MatrixData>\n</CoordinateSystemTransformMatrix>\n";
}

/// Collects the POINTSET, the TRIANGLE array and what the file says of its frame.
class GiftiHandler : public XmlHandler {
public:
    void onStart(const std::string& element, const XmlAttributes& attributes) override {
        if (depth_++ == 0 && element != "GIFTI") {
            damaged("its XML is a " + printable(element) + ", must be GIFTI");
        }
        text_ = nullptr;
        if (element == "DataArray") {
            array_ = nullptr;
            const std::string& intent = requireAttribute(attributes, "Intent");
            if (intent == "NIFTI_INTENT_POINTSET") array_ = &points;
            if (intent == "NIFTI_INTENT_TRIANGLE") array_ = &triangles;
            if (array_ != nullptr) {
                if (!array_->attributes.empty()) {
                    unsupported("it holds several surfaces", "save each to its own file");
                }
                array_->attributes = attributes;
            }
        } else if (element == "Data" && array_ != nullptr) {
            text_ = &array_->text;
        } else if (element == "Name") {
            name_.clear();
            text_ = &name_;
        } else if (element == "Value" && trimmed(name_) == kFrameKey) {
            text_ = &frameName;
        } else if (element == "DataSpace" && array_ == &points) {
            text_ = &dataSpace;
        }
    }
    void onEnd(const std::string& element) override {
        --depth_;
        text_ = nullptr;
        if (element == "DataArray") array_ = nullptr;
    }
    void onText(std::string_view text) override {
        if (text_ != nullptr) text_->append(text);
    }

    GiftiArray points, triangles;
    std::string frameName, dataSpace;

private:
    int depth_ = 0;
    GiftiArray* array_ = nullptr;  ///< the wanted array around this place
    std::string* text_ = nullptr;  ///< where text at this place goes
    std::string name_;
};

/// The numbers of an array that must be N x 3, row by row.
template <class Stored, class T>
std::vector<T> decodeTriples(const GiftiArray& array, std::string_view what) {
    XmlAttributes attributes = array.attributes;
    attributes.try_emplace("Dimensionality", "2");
    attributes.try_emplace("Dim1", "3");
    const GiftiShape shape = shapeOf(attributes, what);
    if (shape.columns != 3) damaged("its " + std::string(what) + " are not an array of N x 3");
    return decodeGiftiRows<Stored, T>(array, shape, what);
}

}  // namespace

void encodeGifti(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    sink << kGiftiHead << "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n";
    if (record.options.saysFrame) {
        sink << "<MetaData>\n<MD><Name><![CDATA[" << kFrameKey << "]]></Name><Value><![CDATA["
             << toString(record.options.frame) << "]]></Value></MD>\n</MetaData>\n";
    } else {
        sink << "<MetaData/>\n";
    }
    sink << "<LabelTable/>\n";

    std::string bytes;
    bytes.reserve(mesh.points.size() * 3 * sizeof(float));
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) appendLittleEndian(static_cast<float>(p[axis]), bytes);
    }
    beginGiftiArray("NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", {std::ssize(mesh.points), 3},
                    sink);
    sink << "<MetaData/>\n";
    encodeCoordinateSystem(record.options, sink);
    endGiftiArray(bytes, sink);

    bytes.clear();
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId vertex : t)
            appendLittleEndian(static_cast<std::int32_t>(vertex), bytes);
    }
    beginGiftiArray("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", {std::ssize(mesh.triangles), 3},
                    sink);
    sink << "<MetaData/>\n";
    endGiftiArray(bytes, sink);
    sink << "</GIFTI>\n";
}

MeshFile decodeGifti(std::string_view bytes) {
    GiftiHandler found;
    parseXml(bytes, found);
    requireGiftiType(found.points, "NIFTI_TYPE_FLOAT32", "points");
    requireGiftiType(found.triangles, "NIFTI_TYPE_INT32", "triangles");

    MeshFile file;
    const auto points = decodeTriples<float, double>(found.points, "points");
    for (std::size_t i = 0; i < points.size(); i += 3) {
        file.mesh.points.push_back({points[i], points[i + 1], points[i + 2]});
    }
    const auto corners = decodeTriples<std::int32_t, VertexId>(found.triangles, "triangles");
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        file.mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
    file.frame = parseCoordinateFrame(trimmed(found.frameName));
    if (!file.frame && trimmed(found.dataSpace) == kScannerSpace) file.frame = CoordinateFrame::Ras;
    return file;
}

}  // namespace adaptiso::meshio
