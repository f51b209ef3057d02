#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>

#include "adaptiso/VtkAdaptor/vtkAdaptisoIsosurface.h"

int main() {
    vtkNew<vtkNIFTIImageReader> reader;
    vtkNew<vtkAdaptisoIsosurface> isosurface;
    isosurface->SetInputConnection(reader->GetOutputPort());
    return isosurface->GetNumberOfInputConnections(0) == 1 ? 0 : 1;
}
