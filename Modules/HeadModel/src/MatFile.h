#pragma once

#include <matio.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::headmodel {

/// A variable of a MATLAB file (level 5), by libmatio.
struct MatFree {
    void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatVariable = std::unique_ptr<matvar_t, MatFree>;

MatVariable matText(const std::string& name, std::string text);
MatVariable matNumber(const std::string& name, double value);
/// Values column by column, `rows` to each.
MatVariable matColumns(const std::string& name, std::size_t rows, std::span<const double> values);
/// One row.
MatVariable matRow(const std::string& name, std::span<const double> values);
/// V x 3
MatVariable matPoints(const std::string& name, std::span<const Vec3> points);
/// T x 3, numbered from 1. \param isClockwise  corners in the other order
MatVariable matTriangles(const std::string& name, std::span<const Triangle> triangles,
                         bool isClockwise = false);
/// One row of texts.
MatVariable matTexts(const std::string& name, std::span<const std::string> texts);
/// An array of structs, each of the same fields in the same order.
MatVariable matStructs(const std::string& name, std::vector<std::vector<MatVariable>> items);

/// Writes variables, packed. The same ones give the same bytes: no date is in the file.
/// \throws FileError
void writeMatFile(const std::filesystem::path& path, std::span<const MatVariable> variables);

/// \throws FileError  "<file>: what is wrong"; also where the variable is not there
MatVariable readMatVariable(const std::filesystem::path& path, const char* name);

/// A field of a struct array's item. \throws FileError  it is not there
matvar_t& matField(matvar_t& item, const char* field, std::size_t index = 0);
/// Inverses of matPoints(), matTriangles(), matRow(), matText(). \throws FileError  another kind
std::vector<Vec3> pointsOf(const matvar_t& variable);
std::vector<Triangle> trianglesOf(const matvar_t& variable, std::size_t points,
                                  bool isClockwise = false);
std::vector<double> valuesOf(const matvar_t& variable);
std::string textOf(const matvar_t& variable);

}  // namespace adaptiso::headmodel
