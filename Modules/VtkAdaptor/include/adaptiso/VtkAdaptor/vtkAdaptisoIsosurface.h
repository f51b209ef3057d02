#pragma once

#include <vtkContourValues.h>
#include <vtkNew.h>
#include <vtkPolyDataAlgorithm.h>

/// Adaptive isosurfaces of a vtkImageData: few triangles within a proved distance of the surface of
/// marching cubes, closed, none crossing another. Stands in for vtkFlyingEdges3D followed by
/// vtkQuadricDecimation.
///
/// Input: an image with one scalar a point, of any numeric type (SetInputArrayToProcess() chooses
/// the array). It is read in place and as a whole; its origin, spacing and direction matrix are
/// honoured. Inside is where scalars are >= the value; NaN is outside.
///
/// Output: one closed surface for each value that the scalars reach, in the order of the values, in
/// the image's coordinates, with double points, triangles counter-clockwise seen from the
/// low-scalar side. Field data: `ErrorBound`, the proved distance to marching cubes, both ways, for
/// each value (0 where it has no surface); `CoordinateFrame` and 3D Slicer's `SPACE` where the
/// frame is known. The same input gives the points and triangles of the program adaptiso-mesh.
///
/// An input that cannot be used is an error event, and an empty output. AbortExecute ends the work
/// at the next progress event or within about 0.1 s, with an empty output.
class vtkAdaptisoIsosurface : public vtkPolyDataAlgorithm {
public:
    static vtkAdaptisoIsosurface* New();
    // clang-format off
    vtkTypeMacro(vtkAdaptisoIsosurface, vtkPolyDataAlgorithm)
    void PrintSelf(ostream& os, vtkIndent indent) override;
    // clang-format on
    vtkMTimeType GetMTime() override;

    /// Isovalues, as of vtkFlyingEdges3D. One value, 0, at first.
    void SetValue(int i, double value) { ContourValues->SetValue(i, value); }
    double GetValue(int i) { return ContourValues->GetValue(i); }
    double* GetValues() { return ContourValues->GetValues(); }
    void SetNumberOfContours(int count) { ContourValues->SetNumberOfContours(count); }
    int GetNumberOfContours() { return ContourValues->GetNumberOfContours(); }
    void GenerateValues(int count, double range[2]) { ContourValues->GenerateValues(count, range); }
    void GenerateValues(int count, double first, double last) {
        ContourValues->GenerateValues(count, first, last);
    }

    /// Largest distance to the surface of marching cubes, both ways, in the image's unit. 0
    /// (default): 0.15 of the least distance between planes of samples, or no bound where
    /// TargetReduction is above 0.
    vtkSetClampMacro(MaximumError, double, 0, VTK_DOUBLE_MAX);
    vtkGetMacro(MaximumError, double);

    /// Share of the triangles of marching cubes to drop, 0 to 1; ends earlier at MaximumError where
    /// that is above 0. 0 (default): as many as MaximumError allows.
    vtkSetClampMacro(TargetReduction, double, 0, 1);
    vtkGetMacro(TargetReduction, double);

    /// Point normals from the image's gradient, towards lower scalars. On by default.
    vtkSetMacro(ComputeNormals, vtkTypeBool);
    vtkGetMacro(ComputeNormals, vtkTypeBool);
    vtkBooleanMacro(ComputeNormals, vtkTypeBool);

    /// Point scalars that hold the isovalue, named as the image's. On by default.
    vtkSetMacro(ComputeScalars, vtkTypeBool);
    vtkGetMacro(ComputeScalars, vtkTypeBool);
    vtkBooleanMacro(ComputeScalars, vtkTypeBool);

    /// Frame of the image's coordinates, mm. Unknown (default): as its field data say
    /// (`CoordinateFrame`, `SPACE`); where they do not, neither does the output.
    enum Frame { FRAME_UNKNOWN, FRAME_RAS, FRAME_LPS };
    vtkSetClampMacro(CoordinateFrame, int, FRAME_UNKNOWN, FRAME_LPS);
    vtkGetMacro(CoordinateFrame, int);
    void SetCoordinateFrameToRAS() { SetCoordinateFrame(FRAME_RAS); }
    void SetCoordinateFrameToLPS() { SetCoordinateFrame(FRAME_LPS); }

protected:
    vtkAdaptisoIsosurface();
    ~vtkAdaptisoIsosurface() override = default;
    int FillInputPortInformation(int port, vtkInformation* information) override;
    int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                            vtkInformationVector* outputs) override;
    int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                    vtkInformationVector* outputs) override;

    vtkNew<vtkContourValues> ContourValues;
    double MaximumError = 0;
    double TargetReduction = 0;
    vtkTypeBool ComputeNormals = 1;
    vtkTypeBool ComputeScalars = 1;
    int CoordinateFrame = FRAME_UNKNOWN;

private:
    vtkAdaptisoIsosurface(const vtkAdaptisoIsosurface&) = delete;
    void operator=(const vtkAdaptisoIsosurface&) = delete;
};
