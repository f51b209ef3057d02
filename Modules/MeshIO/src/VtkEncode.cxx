#include "VtkEncode.h"

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>

#include "adaptiso/MeshIO/VtkAdaptor.h"

namespace adaptiso::meshio {
namespace {

void addField(vtkPolyData& data, const char* name, std::string_view value) {
    vtkNew<vtkStringArray> field;
    field->SetName(name);
    field->InsertNextValue(std::string(value));
    data.GetFieldData()->AddArray(field);
}

template <class Array, class T>
vtkSmartPointer<vtkDataArray> filled(const std::vector<T>& values, int components) {
    auto array = vtkSmartPointer<Array>::New();
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    return array;
}

vtkSmartPointer<vtkDataArray> toVtkArray(const std::vector<double>& values, int components) {
    return filled<vtkDoubleArray>(values, components);
}

vtkSmartPointer<vtkDataArray> toVtkArray(const std::vector<std::int64_t>& values, int components) {
    return filled<vtkTypeInt64Array>(values, components);
}

vtkSmartPointer<vtkDataArray> toVtkArray(const std::vector<Color>& colors, int) {
    auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(colors.size()));
    unsigned char* to = array->GetPointer(0);
    for (const Color& color : colors) to = std::copy(color.begin(), color.end(), to);
    return array;
}

void addPointArrays(vtkPolyData& data, const std::vector<PointArray>& arrays) {
    for (const PointArray& array : arrays) {
        const auto values = std::visit(
            [&](const auto& each) { return toVtkArray(each, array.components); }, array.values);
        values->SetName(array.name.c_str());
        data.GetPointData()->AddArray(values);
    }
    if (!arrays.empty()) data.GetPointData()->SetActiveScalars(arrays.front().name.c_str());
}

void addCellArrays(vtkPolyData& data, const std::vector<CellArray>& arrays) {
    static_assert(sizeof(int) == sizeof(std::int32_t));
    for (const CellArray& each : arrays) {
        vtkNew<vtkIntArray> array;
        array->SetName(each.name.c_str());
        array->SetNumberOfValues(static_cast<vtkIdType>(each.values.size()));
        std::copy(each.values.begin(), each.values.end(), array->GetPointer(0));
        data.GetCellData()->AddArray(array);
    }
    if (!arrays.empty()) data.GetCellData()->SetActiveScalars(arrays.front().name.c_str());
}

}  // namespace

vtkSmartPointer<vtkPolyData> toLabelledPolyData(const MeshRecord& record) {
    auto data = toVtkPolyData(record.mesh);
    addPointArrays(*data, record.options.pointArrays);
    addCellArrays(*data, record.options.cellArrays);
    if (record.options.saysFrame) {
        addField(*data, kFrameFieldName, toString(record.options.frame));
    }
    addField(*data, kVersionFieldName, "1");
    return data;
}

}  // namespace adaptiso::meshio
