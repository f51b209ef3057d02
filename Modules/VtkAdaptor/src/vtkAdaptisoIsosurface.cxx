#include "adaptiso/VtkAdaptor/vtkAdaptisoIsosurface.h"

#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix3x3.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringArray.h>

#include <optional>
#include <utility>

#include "FilterRun.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/NativePixelType.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

vtkStandardNewMacro(vtkAdaptisoIsosurface);

namespace {

using adaptiso::ImageGeometry;
using adaptiso::InvalidInput;
using adaptiso::TriangleMesh;
using adaptiso::Vec3;
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// RAS to LPS. Zero stays positive, as readers have it: all ways to a surface give the same bits.
Vec3 turned(const Vec3& v) {
    return {v.x == 0 ? 0 : -v.x, v.y == 0 ? 0 : -v.y, v.z};
}

/// \param isLps  of the image's coordinates; otherwise they are turned as RAS is
ImageGeometry geometryOf(vtkImageData& image, bool isLps) {
    ImageGeometry geometry;
    int extent[6];
    image.GetExtent(extent);
    const int first[3]{extent[0], extent[2], extent[4]};
    image.TransformIndexToPhysicalPoint(first, &geometry.originMm.x);
    for (int axis = 0; axis < 3; ++axis) {
        geometry.size[axis] = image.GetDimensions()[axis];
        Vec3& step = geometry.indexToPhysical.column[axis];
        for (int row = 0; row < 3; ++row) {
            step[row] =
                image.GetDirectionMatrix()->GetElement(row, axis) * image.GetSpacing()[axis];
        }
        if (!isLps) step = turned(step);
    }
    if (!isLps) geometry.originMm = turned(geometry.originMm);
    return geometry;
}

void requireUsable(vtkImageData& image, const vtkDataArray* scalars) {
    if (scalars == nullptr) throw InvalidInput("the image has no point scalars");
    const auto* array = const_cast<vtkDataArray*>(scalars);
    if (array->GetNumberOfComponents() != 1) {
        throw InvalidInput("the scalars have " + std::to_string(array->GetNumberOfComponents()) +
                           " components, must have 1 (vtkImageExtractComponents takes one)");
    }
    if (array->GetNumberOfTuples() != image.GetNumberOfPoints()) {
        throw InvalidInput("the scalars are not one a point of the image");
    }
    if (image.HasAnyBlankPoints() || image.HasAnyBlankCells()) {
        throw InvalidInput("the image has blanked points, which have no place in a closed surface");
    }
}

/// The scalars in place; those of another layout than one block are first copied into `copy`.
adaptiso::VolumeView viewOf(vtkDataArray* scalars, const ImageGeometry& geometry,
                            vtkSmartPointer<vtkDataArray>& copy) {
    if (!scalars->HasStandardMemoryLayout()) {
        copy.TakeReference(vtkDataArray::CreateDataArray(scalars->GetDataType()));
        copy->DeepCopy(scalars);
        scalars = copy;
    }
    switch (scalars->GetDataType()) {
        vtkTemplateMacro(return adaptiso::VolumeView(
            scalars->GetVoidPointer(0), adaptiso::nativePixelType<VTK_TT>(), geometry));
        default:
            throw InvalidInput("the scalars are no numbers");
    }
}

void append(TriangleMesh&& mesh, TriangleMesh& all) {
    if (all.points.empty()) {
        all = std::move(mesh);
        return;
    }
    const auto first = static_cast<adaptiso::VertexId>(all.points.size());
    all.points.insert(all.points.end(), mesh.points.begin(), mesh.points.end());
    all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
    for (const adaptiso::Triangle& corners : mesh.triangles) {
        all.triangles.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
    }
}

/// The frame that an image's field data name.
int statedFrame(vtkImageData& image) {
    for (const char* name : {"CoordinateFrame", "SPACE"}) {
        const auto* array =
            vtkStringArray::SafeDownCast(image.GetFieldData()->GetAbstractArray(name));
        if (array == nullptr || array->GetNumberOfValues() != 1) continue;
        const vtkStdString text = const_cast<vtkStringArray*>(array)->GetValue(0).substr(0, 3);
        if (text == "RAS") return vtkAdaptisoIsosurface::FRAME_RAS;
        if (text == "LPS") return vtkAdaptisoIsosurface::FRAME_LPS;
    }
    return vtkAdaptisoIsosurface::FRAME_UNKNOWN;
}

void addText(vtkPolyData& data, const char* name, const char* text) {
    vtkNew<vtkStringArray> array;
    array->SetName(name);
    array->InsertNextValue(text);
    data.GetFieldData()->AddArray(array);
}

}  // namespace

vtkAdaptisoIsosurface::vtkAdaptisoIsosurface() {
    SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                           vtkDataSetAttributes::SCALARS);
}

void vtkAdaptisoIsosurface::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    ContourValues->PrintSelf(os, indent);
    os << indent << "MaximumError: " << MaximumError << "\n"
       << indent << "TargetReduction: " << TargetReduction << "\n"
       << indent << "ComputeNormals: " << ComputeNormals << "\n"
       << indent << "ComputeScalars: " << ComputeScalars << "\n"
       << indent << "CoordinateFrame: " << CoordinateFrame << "\n";
}

vtkMTimeType vtkAdaptisoIsosurface::GetMTime() {
    return std::max(Superclass::GetMTime(), ContourValues->GetMTime());
}

int vtkAdaptisoIsosurface::FillInputPortInformation(int, vtkInformation* information) {
    information->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    return 1;
}

int vtkAdaptisoIsosurface::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                               vtkInformationVector*) {
    vtkInformation* const input = inputs[0]->GetInformationObject(0);
    int whole[6];
    input->Get(Pipeline::WHOLE_EXTENT(), whole);
    input->Set(Pipeline::UPDATE_EXTENT(), whole, 6);
    return 1;
}

int vtkAdaptisoIsosurface::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                       vtkInformationVector* outputs) {
    vtkImageData* const image = vtkImageData::GetData(inputs[0]);
    vtkPolyData* const output = vtkPolyData::GetData(outputs);
    // the whole surface is piece 0
    if (outputs->GetInformationObject(0)->Get(Pipeline::UPDATE_PIECE_NUMBER()) > 0) return 1;
    vtkDataArray* const scalars = GetInputArrayToProcess(0, inputs);
    const int frame = CoordinateFrame == FRAME_UNKNOWN ? statedFrame(*image) : CoordinateFrame;
    const bool isLps = frame == FRAME_LPS;
    const int count = GetNumberOfContours();

    TriangleMesh all;
    vtkNew<vtkDoubleArray> values, bounds;
    adaptiso::vtk::FilterRun run(*this);
    const std::string fault = run.run([&] {
        requireUsable(*image, scalars);
        vtkSmartPointer<vtkDataArray> copy;
        const adaptiso::VolumeView volume = viewOf(scalars, geometryOf(*image, isLps), copy);
        std::optional<adaptiso::SpanSpaceIndex> index;
        if (count > 1) index = adaptiso::SpanSpaceIndex::build(volume, {});
        for (int n = 0; n < count; ++n) {
            adaptiso::ExtractionOptions options;
            options.isovalue = GetValue(n);
            options.computeNormals = ComputeNormals != 0;
            if (MaximumError > 0) options.adaptive.maxErrorMm = MaximumError;
            if (TargetReduction > 0) options.adaptive.reduction = TargetReduction;
            options.progress = run.progress(n, count);
            adaptiso::Extraction made = index ? adaptiso::extractSurface(volume, *index, options)
                                              : adaptiso::extractSurface(volume, options);
            for (std::size_t p = 0; p < made.mesh.points.size(); ++p) {
                values->InsertNextValue(options.isovalue);
            }
            bounds->InsertNextValue(made.statistics.errorBoundMm.value_or(0));
            append(std::move(made.mesh), all);
        }
    });
    if (!fault.empty()) {
        vtkErrorMacro(<< fault);
        return 0;
    }
    if (run.isAborted()) return 1;
    if (!isLps) {
        for (Vec3& point : all.points) point = {0 - point.x, 0 - point.y, point.z};  // no -0
        for (adaptiso::Normal& normal : all.normals) normal = {-normal.x, -normal.y, normal.z};
    }
    const auto surface = adaptiso::toVtkPolyData(all);
    output->SetPoints(surface->GetPoints());
    output->SetPolys(surface->GetPolys());
    output->GetPointData()->ShallowCopy(surface->GetPointData());
    if (ComputeScalars) {
        values->SetName(scalars->GetName());
        output->GetPointData()->SetScalars(values);
    }
    bounds->SetName("ErrorBound");
    output->GetFieldData()->AddArray(bounds);
    if (frame != FRAME_UNKNOWN) {
        addText(*output, "CoordinateFrame", isLps ? "LPS mm" : "RAS mm");
        addText(*output, "SPACE", isLps ? "LPS" : "RAS");
    }
    return 1;
}
