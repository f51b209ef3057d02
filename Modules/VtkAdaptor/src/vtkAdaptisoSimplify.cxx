#include "adaptiso/VtkAdaptor/vtkAdaptisoSimplify.h"

#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "FilterRun.h"
#include "adaptiso/Extraction/PointTransfer.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

vtkStandardNewMacro(vtkAdaptisoSimplify);

namespace {

using adaptiso::PointTransfer;
using adaptiso::TriangleMesh;

/// Numbers on a scale, or colours; not labels.
bool canBeMixed(const vtkAbstractArray* values) {
    const auto* array = const_cast<vtkAbstractArray*>(values);
    const int type = array->GetDataType();
    const int components = array->GetNumberOfComponents();
    return type == VTK_DOUBLE || type == VTK_FLOAT ||
           (type == VTK_UNSIGNED_CHAR && (components == 3 || components == 4));
}

vtkSmartPointer<vtkAbstractArray> carried(vtkAbstractArray* from, const PointTransfer& transfer) {
    auto to = vtkSmartPointer<vtkAbstractArray>::Take(from->NewInstance());
    to->SetName(from->GetName());
    to->SetNumberOfComponents(from->GetNumberOfComponents());
    to->CopyComponentNames(from);
    to->SetNumberOfTuples(static_cast<vtkIdType>(transfer.size()));
    vtkNew<vtkIdList> corners;
    const bool isMixed = canBeMixed(from);
    for (std::size_t p = 0; p < transfer.size(); ++p) {
        const auto point = static_cast<vtkIdType>(p);
        if (!isMixed) {
            to->SetTuple(point, transfer.nearestCorner(p), from);
            continue;
        }
        // a corner without weight may hold NaN
        corners->Reset();
        double weights[3];
        for (int c = 0; c < 3; ++c) {
            if (transfer.weights(p)[c] == 0) continue;
            weights[corners->GetNumberOfIds()] = transfer.weights(p)[c];
            corners->InsertNextId(transfer.corners(p)[c]);
        }
        to->InterpolateTuple(point, corners, from, weights);
    }
    return to;
}

void carryPointData(vtkPointData& from, const TriangleMesh& input, const TriangleMesh& result,
                    vtkPointData& to) {
    const PointTransfer transfer(input, result);
    for (int n = 0; n < from.GetNumberOfArrays(); ++n) {
        vtkAbstractArray* const array = from.GetAbstractArray(n);
        const int attribute = from.IsArrayAnAttribute(n);
        if (attribute == vtkDataSetAttributes::NORMALS) {  // simplify() has them
            to.GetNormals()->SetName(array->GetName());
            continue;
        }
        const int place = to.AddArray(carried(array, transfer));
        if (attribute >= 0) to.SetActiveAttribute(place, attribute);
    }
}

}  // namespace

void vtkAdaptisoSimplify::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "MaximumError: " << MaximumError << "\n"
       << indent << "TargetReduction: " << TargetReduction << "\n"
       << indent << "KeepBorders: " << KeepBorders << "\n";
}

int vtkAdaptisoSimplify::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                     vtkInformationVector* outputs) {
    vtkPolyData* const input = vtkPolyData::GetData(inputs[0]);
    vtkPolyData* const output = vtkPolyData::GetData(outputs);
    if (input->GetNumberOfPolys() == 0 && input->GetNumberOfStrips() == 0) return 1;
    adaptiso::Simplified made;
    vtkSmartPointer<vtkPolyData> surface;
    adaptiso::vtk::FilterRun run(*this);
    const std::string fault = run.run([&] {
        const TriangleMesh mesh = adaptiso::fromVtkPolyData(input);
        adaptiso::SimplifyOptions options;
        if (MaximumError > 0) options.maxErrorMm = MaximumError;
        if (TargetReduction > 0) options.reduction = TargetReduction;
        options.keepBorders = KeepBorders != 0;
        options.progress = run.progress();
        made = adaptiso::simplify(mesh, options);
        surface = adaptiso::toVtkPolyData(made.mesh);
        carryPointData(*input->GetPointData(), mesh, made.mesh, *surface->GetPointData());
    });
    if (!fault.empty()) {
        vtkErrorMacro(<< fault);
        return 0;
    }
    if (run.isAborted()) return 1;
    output->SetPoints(surface->GetPoints());
    output->SetPolys(surface->GetPolys());
    output->GetPointData()->ShallowCopy(surface->GetPointData());
    vtkNew<vtkDoubleArray> bound;
    bound->SetName("ErrorBound");
    bound->InsertNextValue(made.statistics.errorBoundMm);
    output->GetFieldData()->AddArray(bound);
    return 1;
}
