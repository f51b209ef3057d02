#pragma once

#include <itkImage.h>
#include <itkImageRegionConstIterator.h>
#include <itkImageRegionIterator.h>
#include <itkImageToMeshFilter.h>

#include <type_traits>

#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/ItkAdaptor/ItkImageAdaptor.h"
#include "adaptiso/ItkAdaptor/ItkMeshAdaptor.h"

namespace adaptiso {
namespace detail {

/// extractSurface() inside an ITK filter: progress events out, AbortGenerateData in.
/// \throws itk::ProcessAborted, itk::ExceptionObject with the library's line
Extraction extractInFilter(itk::ProcessObject& filter, const VolumeView& volume,
                           ExtractionOptions options, Border border);

}  // namespace detail

/// The adaptive isosurface of an image: a closed mesh with few triangles, within a proved distance
/// of the surface of marching cubes, none crossing another.
///
/// Input: a 3-D image of any scalar type, taken as a whole: an itk::Image is read in place, any
/// other image is copied. Inside is where samples are >= Isovalue; NaN is outside. Direction and
/// spacing are honoured. Output: LPS mm, triangles counter-clockwise seen from the low side; with
/// coordinates of type double to the bit those of adaptiso-mesh. Empty where no sample, or every
/// one with an open border, reaches the isovalue.
///
/// \tparam TOutputMesh  itk::Mesh or itk::QuadEdgeMesh. The coordinates of itk::Mesh<double, 3> are
/// float;
///                      those of ItkMesh are double
template <class TInputImage, class TOutputMesh = ItkMesh<double>>
class AdaptiveIsosurfaceMeshFilter : public itk::ImageToMeshFilter<TInputImage, TOutputMesh> {
public:
    using Self = AdaptiveIsosurfaceMeshFilter;
    using Superclass = itk::ImageToMeshFilter<TInputImage, TOutputMesh>;
    using Pointer = itk::SmartPointer<Self>;
    using ConstPointer = itk::SmartPointer<const Self>;
    static_assert(TInputImage::ImageDimension == 3);
    static_assert(std::is_arithmetic_v<typename TInputImage::PixelType>);

    // clang-format off
    itkNewMacro(Self)
    itkTypeMacro(AdaptiveIsosurfaceMeshFilter, itk::ImageToMeshFilter);
    // clang-format on

    itkSetMacro(Isovalue, double);
    itkGetConstMacro(Isovalue, double);

    /// Largest distance to the surface of marching cubes, both ways, mm. 0 (default): 0.15 of the
    /// least distance between planes of samples, or no bound where NumberOfTriangles is set.
    itkSetMacro(MaxError, double);
    itkGetConstMacro(MaxError, double);

    /// Triangles to simplify to; ends earlier at MaxError where that is set. 0 (default): as many
    /// as MaxError allows.
    itkSetMacro(NumberOfTriangles, itk::IdentifierType);
    itkGetConstMacro(NumberOfTriangles, itk::IdentifierType);

    /// The surface is closed where the inside reaches the image's border (default), or left open.
    itkSetMacro(ClosedBorder, bool);
    itkGetConstMacro(ClosedBorder, bool);
    itkBooleanMacro(ClosedBorder);

    /// Proved distance of the output to the surface of marching cubes, both ways, mm.
    itkGetConstMacro(ErrorBound, double);

protected:
    void GenerateInputRequestedRegion() override {
        Superclass::GenerateInputRequestedRegion();
        const_cast<TInputImage*>(this->GetInput())->SetRequestedRegionToLargestPossibleRegion();
    }

    void GenerateData() override {
        ExtractionOptions options;
        options.isovalue = m_Isovalue;
        options.computeNormals = false;
        if (m_MaxError != 0) options.adaptive.maxErrorMm = m_MaxError;
        if (m_NumberOfTriangles > 0) {
            options.adaptive.maxTriangles = static_cast<std::int64_t>(m_NumberOfTriangles);
        }
        const typename PlainImage::ConstPointer image = plainInput();
        const Extraction made = detail::extractInFilter(
            *this, viewItkImage(*image), options, m_ClosedBorder ? Border::Closed : Border::Open);
        m_ErrorBound = made.statistics.errorBoundMm.value_or(0);
        fillItkMesh(made.mesh, *this->GetOutput());
    }

private:
    using PlainImage = itk::Image<typename TInputImage::PixelType, 3>;

    typename PlainImage::ConstPointer plainInput() {
        const TInputImage* const input = this->GetInput();
        if constexpr (std::is_base_of_v<PlainImage, TInputImage>) {
            return input;
        } else {
            auto copy = PlainImage::New();
            copy->CopyInformation(input);
            copy->SetRegions(input->GetBufferedRegion());
            copy->Allocate();
            itk::ImageRegionConstIterator<TInputImage> from(input, input->GetBufferedRegion());
            itk::ImageRegionIterator<PlainImage> to(copy, input->GetBufferedRegion());
            for (; !from.IsAtEnd(); ++from, ++to) to.Set(from.Get());
            return copy.GetPointer();
        }
    }

    double m_Isovalue = 0, m_MaxError = 0, m_ErrorBound = 0;
    itk::IdentifierType m_NumberOfTriangles = 0;
    bool m_ClosedBorder = true;
};

}  // namespace adaptiso
