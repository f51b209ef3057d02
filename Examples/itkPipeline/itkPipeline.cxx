// An ITK pipeline with adaptiso's filter in it: itkPipeline IMAGE ISOVALUE SURFACE.vtk. The
// surface's points are in LPS mm, as ITK's images are.
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkMeshFileWriter.h>

#include <cstdlib>
#include <iostream>

#include "adaptiso/ItkAdaptor/AdaptiveIsosurfaceMeshFilter.h"

int main(int argc, char** argv) {
    if (argc != 4) {
        std::cerr << "usage: itkPipeline IMAGE ISOVALUE SURFACE.vtk\n";
        return 2;
    }
    using Image = itk::Image<float, 3>;
    using Mesh = adaptiso::ItkMesh<double>;
    auto reader = itk::ImageFileReader<Image>::New();
    reader->SetFileName(argv[1]);
    auto surface = adaptiso::AdaptiveIsosurfaceMeshFilter<Image, Mesh>::New();
    surface->SetInput(reader->GetOutput());
    surface->SetIsovalue(std::atof(argv[2]));
    auto writer = itk::MeshFileWriter<Mesh>::New();
    writer->SetInput(surface->GetOutput());
    writer->SetFileName(argv[3]);
    try {
        writer->Update();
    } catch (const itk::ExceptionObject& error) {
        std::cerr << error.GetDescription() << '\n';
        return 1;
    }
    std::cout << surface->GetOutput()->GetNumberOfCells() << " triangles within "
              << surface->GetErrorBound() << " mm\n";
    return 0;
}
