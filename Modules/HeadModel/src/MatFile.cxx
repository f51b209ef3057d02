#include "MatFile.h"

#include <array>
#include <cmath>
#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::headmodel {
namespace {

struct MatClose {
    void operator()(mat_t* file) const { Mat_Close(file); }
};
using OpenMat = std::unique_ptr<mat_t, MatClose>;

/// Every level 5 file begins with these words; libmatio would add host and date.
constexpr const char* kHeader = "MATLAB 5.0 MAT-file, Created By: adaptiso";

MatVariable made(matvar_t* variable) {
    if (variable == nullptr) throw std::bad_alloc();
    return MatVariable(variable);
}

MatVariable matrix(const std::string& name, std::size_t rows, std::size_t columns,
                   std::vector<double> columnsFirst) {
    std::array<std::size_t, 2> size{rows, columns};
    return made(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(),
                              columnsFirst.data(), 0));
}

[[noreturn]] void refuse(const std::string& what) {
    throw FileError(what + "; the file is damaged or not what its name says: replace it");
}

/// Rows of three doubles.
std::size_t rowsOf(const matvar_t& variable) {
    if (variable.class_type != MAT_C_DOUBLE || variable.data_type != MAT_T_DOUBLE ||
        variable.rank != 2 || variable.dims[1] != 3 || variable.data == nullptr) {
        refuse(std::string("its variable ") + (variable.name != nullptr ? variable.name : "") +
               " is no matrix of doubles with three columns");
    }
    return variable.dims[0];
}

}  // namespace

MatVariable matText(const std::string& name, std::string text) {
    std::array<std::size_t, 2> size{1, text.size()};
    return made(
        Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, size.data(), text.data(), 0));
}

MatVariable matNumber(const std::string& name, double value) {
    return matrix(name, 1, 1, {value});
}

MatVariable matColumns(const std::string& name, std::size_t rows, std::span<const double> values) {
    return matrix(name, rows, values.size() / rows, {values.begin(), values.end()});
}

MatVariable matRow(const std::string& name, std::span<const double> values) {
    return matColumns(name, 1, values);
}

MatVariable matPoints(const std::string& name, std::span<const Vec3> points) {
    std::vector<double> values;
    values.reserve(3 * points.size());
    for (int axis = 0; axis < 3; ++axis) {
        for (const Vec3& point : points) values.push_back(point[axis]);
    }
    return matrix(name, points.size(), 3, std::move(values));
}

MatVariable matTriangles(const std::string& name, std::span<const Triangle> triangles,
                         bool isClockwise) {
    std::vector<double> values;
    values.reserve(3 * triangles.size());
    for (const std::size_t corner :
         isClockwise ? std::array<std::size_t, 3>{1, 0, 2} : std::array<std::size_t, 3>{0, 1, 2}) {
        for (const Triangle& triangle : triangles) {
            values.push_back(static_cast<double>(triangle[corner] + 1));
        }
    }
    return matrix(name, triangles.size(), 3, std::move(values));
}

MatVariable matTexts(const std::string& name, std::span<const std::string> texts) {
    std::vector<matvar_t*> cells;
    for (const std::string& text : texts) cells.push_back(matText("", text).release());
    std::array<std::size_t, 2> size{1, cells.size()};
    // the array copies the pointers and owns what they point to
    return made(
        Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, 2, size.data(), cells.data(), 0));
}

MatVariable matStructs(const std::string& name, std::vector<std::vector<MatVariable>> items) {
    std::vector<const char*> fields;
    for (const MatVariable& field : items.at(0)) fields.push_back(field->name);
    std::array<std::size_t, 2> size{1, items.size()};
    MatVariable array = made(Mat_VarCreateStruct(name.c_str(), 2, size.data(), fields.data(),
                                                 static_cast<unsigned>(fields.size())));
    for (std::size_t index = 0; index < items.size(); ++index) {
        for (MatVariable& field : items[index]) {
            const std::string key = field->name;
            Mat_VarSetStructFieldByName(array.get(), key.c_str(), index, field.release());
        }
    }
    return array;
}

void writeMatFile(const std::filesystem::path& path, std::span<const MatVariable> variables) {
    const OpenMat file(Mat_CreateVer(path.c_str(), kHeader, MAT_FT_MAT5));
    bool isWritten = file != nullptr;
    for (const MatVariable& variable : variables) {
        isWritten =
            isWritten && Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_ZLIB) == 0;
    }
    if (isWritten) return;
    throw FileError(path.string() +
                    ": can't be written; check that its folder may be written to, and the disk");
}

MatVariable readMatVariable(const std::filesystem::path& path, const char* name) {
    const OpenMat file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
    if (file == nullptr) throw FileError(path.string() + ": is no MATLAB file that can be opened");
    MatVariable variable(Mat_VarRead(file.get(), name));
    if (variable == nullptr) {
        throw FileError(path.string() + ": holds no variable " + std::string(name));
    }
    return variable;
}

matvar_t& matField(matvar_t& item, const char* field, std::size_t index) {
    matvar_t* const found = item.class_type == MAT_C_STRUCT
                                ? Mat_VarGetStructFieldByName(&item, field, index)
                                : nullptr;
    if (found == nullptr) refuse("it lacks the field " + std::string(field));
    return *found;
}

std::vector<Vec3> pointsOf(const matvar_t& variable) {
    const std::size_t rows = rowsOf(variable);
    const auto* const values = static_cast<const double*>(variable.data);
    std::vector<Vec3> points(rows);
    for (std::size_t n = 0; n < rows; ++n) {
        points[n] = {values[n], values[rows + n], values[2 * rows + n]};
        if (!std::isfinite(squaredNorm(points[n]))) refuse("a point is not finite");
    }
    return points;
}

std::vector<Triangle> trianglesOf(const matvar_t& variable, std::size_t points, bool isClockwise) {
    const std::size_t rows = rowsOf(variable);
    const auto* const values = static_cast<const double*>(variable.data);
    std::vector<Triangle> triangles(rows);
    for (std::size_t n = 0; n < rows; ++n) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const double number = values[corner * rows + n];
            if (!(number >= 1) || !(number <= static_cast<double>(points))) {
                refuse("a triangle names a point that is not there");
            }
            triangles[n][corner] = static_cast<VertexId>(number) - 1;
        }
        if (isClockwise) std::swap(triangles[n][0], triangles[n][1]);
    }
    return triangles;
}

std::vector<double> valuesOf(const matvar_t& variable) {
    if (variable.class_type != MAT_C_DOUBLE || variable.data_type != MAT_T_DOUBLE ||
        variable.rank != 2 || variable.data == nullptr) {
        refuse("it holds no doubles where they are due");
    }
    const auto* const values = static_cast<const double*>(variable.data);
    return {values, values + variable.dims[0] * variable.dims[1]};
}

std::string textOf(const matvar_t& variable) {
    if (variable.class_type != MAT_C_CHAR || variable.data == nullptr) {
        refuse("it holds no text where it is due");
    }
    return {static_cast<const char*>(variable.data), variable.nbytes};
}

}  // namespace adaptiso::headmodel
