#include "FlyingEdges.h"

#include <vtkDataArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkType.h>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::benchmarks {
namespace {

int vtkTypeOf(PixelType type) {
    switch (type) {
        case PixelType::UInt8:
            return VTK_TYPE_UINT8;
        case PixelType::Int8:
            return VTK_TYPE_INT8;
        case PixelType::UInt16:
            return VTK_TYPE_UINT16;
        case PixelType::Int16:
            return VTK_TYPE_INT16;
        case PixelType::UInt32:
            return VTK_TYPE_UINT32;
        case PixelType::Int32:
            return VTK_TYPE_INT32;
        case PixelType::UInt64:
            return VTK_TYPE_UINT64;
        case PixelType::Int64:
            return VTK_TYPE_INT64;
        case PixelType::Float32:
            return VTK_TYPE_FLOAT32;
        case PixelType::Float64:
            return VTK_TYPE_FLOAT64;
    }
    throw InternalError("vtkTypeOf: unknown pixel type");
}

void setGeometry(vtkImageData& image, const ImageGeometry& geometry) {
    const Vec3 spacingMm = geometry.spacingMm();
    image.SetDimensions(static_cast<int>(geometry.size[0]), static_cast<int>(geometry.size[1]),
                        static_cast<int>(geometry.size[2]));
    image.SetOrigin(geometry.originMm.x, geometry.originMm.y, geometry.originMm.z);
    image.SetSpacing(spacingMm.x, spacingMm.y, spacingMm.z);
    double direction[9];  // by rows
    for (int row = 0; row < 3; ++row) {
        for (int axis = 0; axis < 3; ++axis) {
            direction[3 * row + axis] =
                geometry.indexToPhysical.column[axis][row] / spacingMm[axis];
        }
    }
    image.SetDirectionMatrix(direction);
}

}  // namespace

vtkSmartPointer<vtkImageData> asVtkImage(const VolumeView& volume) {
    const auto scalars = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(vtkTypeOf(volume.pixelType())));
    constexpr int kKeepOwnership = 1;  // VTK must not free the samples; filters only read them
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): VTK has no array of constants
    scalars->SetVoidArray(const_cast<void*>(volume.samples()),
                          static_cast<vtkIdType>(volume.geometry().voxelCount()), kKeepOwnership);
    auto image = vtkSmartPointer<vtkImageData>::New();
    setGeometry(*image, volume.geometry());
    image->GetPointData()->SetScalars(scalars);
    return image;
}

vtkSmartPointer<vtkPolyData> flyingEdges(vtkImageData* image, double isovalue,
                                         bool computeNormals) {
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    filter->SetValue(0, isovalue);
    filter->SetComputeNormals(computeNormals ? 1 : 0);
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    filter->Update();
    return filter->GetOutput();
}

}  // namespace adaptiso::benchmarks
