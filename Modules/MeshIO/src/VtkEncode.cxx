#include "VtkEncode.h"

#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkStringArray.h>

#include "adaptiso/MeshIO/VtkAdaptor.h"

namespace adaptiso::meshio {
namespace {

void addField(vtkPolyData& data, const char* name, std::string_view value) {
    vtkNew<vtkStringArray> field;
    field->SetName(name);
    field->InsertNextValue(std::string(value));
    data.GetFieldData()->AddArray(field);
}

}  // namespace

vtkSmartPointer<vtkPolyData> toLabelledPolyData(const MeshRecord& record) {
    auto data = toVtkPolyData(record.mesh);
    addField(*data, kFrameFieldName, toString(record.options.frame));
    addField(*data, kVersionFieldName, "1");
    return data;
}

}  // namespace adaptiso::meshio
