#include "VtkThreads.h"

#include <vtkSMPTools.h>
#include <vtkVersion.h>

namespace adaptiso::benchmarks {

VtkThreads setVtkThreads(int threads) {
    vtkSMPTools::Initialize(threads);
    const std::string backend = vtkSMPTools::GetBackend();
    return {backend, backend == "Sequential" ? 1 : vtkSMPTools::GetEstimatedNumberOfThreads()};
}

std::string vtkVersionText() {
    return vtkVersion::GetVTKVersion();
}

}  // namespace adaptiso::benchmarks
