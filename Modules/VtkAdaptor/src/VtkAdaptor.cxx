#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <cstring>
#include <string>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

// arrays are copied as blocks of memory
static_assert(sizeof(Vec3) == 3 * sizeof(double));
static_assert(sizeof(Normal) == 3 * sizeof(float));
static_assert(sizeof(Triangle) == 3 * sizeof(vtkIdType));

template <class Array, class Row>
vtkSmartPointer<Array> copiedArray(const std::vector<Row>& rows) {
    auto array = vtkSmartPointer<Array>::New();
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(rows.size()));
    if (!rows.empty()) {
        std::memcpy(array->GetPointer(0), rows.data(), rows.size() * sizeof(Row));
    }
    return array;
}

vtkSmartPointer<vtkCellArray> toCells(const std::vector<Triangle>& triangles) {
    const auto count = static_cast<vtkIdType>(triangles.size());
    vtkNew<vtkIdTypeArray> offsets;
    offsets->SetNumberOfValues(count + 1);
    for (vtkIdType i = 0; i <= count; ++i) offsets->SetValue(i, 3 * i);
    vtkNew<vtkIdTypeArray> corners;
    corners->SetNumberOfValues(3 * count);
    if (count > 0) {
        std::memcpy(corners->GetPointer(0), triangles.data(), triangles.size() * sizeof(Triangle));
    }
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    cells->SetData(offsets, corners);
    return cells;
}

[[noreturn]] void refuse(const std::string& fault) {
    throw InvalidInput("fromVtkPolyData: " + fault);
}

void copyNormals(vtkPolyData& data, TriangleMesh& mesh) {
    vtkDataArray* const normals = data.GetPointData()->GetNormals();
    if (normals == nullptr) return;
    const vtkIdType points = data.GetNumberOfPoints();
    if (normals->GetNumberOfComponents() != 3 || normals->GetNumberOfTuples() != points) {
        refuse("the normals are " + std::to_string(normals->GetNumberOfTuples()) +
               " tuples, must be one 3-vector for each of " + std::to_string(points) + " points");
    }
    mesh.normals.reserve(points);
    for (vtkIdType i = 0; i < points; ++i) {
        double v[3];
        normals->GetTuple(i, v);
        mesh.normals.push_back(toNormal({v[0], v[1], v[2]}));
    }
}

void copyTriangles(vtkPolyData& data, TriangleMesh& mesh) {
    vtkCellArray* const polys = data.GetPolys();
    const vtkIdType points = data.GetNumberOfPoints();
    mesh.triangles.reserve(polys->GetNumberOfCells());
    for (vtkIdType cell = 0; cell < polys->GetNumberOfCells(); ++cell) {
        vtkIdType corners = 0;
        const vtkIdType* ids = nullptr;
        polys->GetCellAtId(cell, corners, ids);
        if (corners != 3) {
            refuse("polygon " + std::to_string(cell) + " has " + std::to_string(corners) +
                   " corners, must have 3 (vtkTriangleFilter makes them)");
        }
        for (int corner = 0; corner < 3; ++corner) {
            if (ids[corner] < 0 || ids[corner] >= points) {
                refuse("polygon " + std::to_string(cell) + " uses point " +
                       std::to_string(ids[corner]) + ", must be 0 to " +
                       std::to_string(points - 1));
            }
        }
        mesh.triangles.push_back({ids[0], ids[1], ids[2]});
    }
}

}  // namespace

vtkSmartPointer<vtkPolyData> toVtkPolyData(const TriangleMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetData(copiedArray<vtkDoubleArray>(mesh.points));
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(toCells(mesh.triangles));
    if (!mesh.normals.empty()) {
        const auto normals = copiedArray<vtkFloatArray>(mesh.normals);
        normals->SetName("Normals");
        data->GetPointData()->SetNormals(normals);
    }
    return data;
}

TriangleMesh fromVtkPolyData(vtkPolyData* data) {
    if (data == nullptr) refuse("no data given");
    if (data->GetNumberOfStrips() > 0) {
        refuse("the data has triangle strips, must have triangles (vtkTriangleFilter makes them)");
    }
    TriangleMesh mesh;
    mesh.points.resize(data->GetNumberOfPoints());
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) data->GetPoint(i, &mesh.points[i].x);
    copyNormals(*data, mesh);
    copyTriangles(*data, mesh);
    return mesh;
}

}  // namespace adaptiso
