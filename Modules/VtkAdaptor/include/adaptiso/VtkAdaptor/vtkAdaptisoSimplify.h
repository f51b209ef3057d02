#pragma once

#include <vtkPolyDataAlgorithm.h>

/// Fewer triangles within a proved distance, without new crossings or holes. Stands in for
/// vtkQuadricDecimation and vtkDecimatePro.
///
/// Input: triangles (vtkTriangleFilter makes them of polygons and strips); vertices and lines are
/// left out. Closed surfaces stay closed with the same pieces and genus, open borders stay open.
///
/// Output: double points. Point data come along: floating-point values and colours (unsigned char,
/// 3 or 4 components) are interpolated, all others taken from the nearest corner, so that labels
/// stay labels. Cell data do not. Field data: the input's, and `ErrorBound`, the proved distance
/// between input and output, both ways.
///
/// Errors and AbortExecute: as of vtkAdaptisoIsosurface.
class vtkAdaptisoSimplify : public vtkPolyDataAlgorithm {
public:
    static vtkAdaptisoSimplify* New();
    // clang-format off
    vtkTypeMacro(vtkAdaptisoSimplify, vtkPolyDataAlgorithm)
    void PrintSelf(ostream& os, vtkIndent indent) override;
    // clang-format on

    /// Largest distance between input and output, both ways, in the points' unit. 0 (default): no
    /// bound; then TargetReduction must be above 0.
    vtkSetClampMacro(MaximumError, double, 0, VTK_DOUBLE_MAX);
    vtkGetMacro(MaximumError, double);

    /// Share of the triangles to drop, 0 to 1; ends earlier at MaximumError where that is above 0.
    /// 0 (default): as many as MaximumError allows.
    vtkSetClampMacro(TargetReduction, double, 0, 1);
    vtkGetMacro(TargetReduction, double);

    /// Vertices on open borders stay, bit by bit. Off by default.
    vtkSetMacro(KeepBorders, vtkTypeBool);
    vtkGetMacro(KeepBorders, vtkTypeBool);
    vtkBooleanMacro(KeepBorders, vtkTypeBool);

protected:
    vtkAdaptisoSimplify() = default;
    ~vtkAdaptisoSimplify() override = default;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                    vtkInformationVector* outputs) override;

    double MaximumError = 0;
    double TargetReduction = 0;
    vtkTypeBool KeepBorders = 0;

private:
    vtkAdaptisoSimplify(const vtkAdaptisoSimplify&) = delete;
    void operator=(const vtkAdaptisoSimplify&) = delete;
};
