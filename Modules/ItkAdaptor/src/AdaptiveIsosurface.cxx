#include <algorithm>
#include <functional>

#include "adaptiso/Core/Progress.h"
#include "adaptiso/ItkAdaptor/AdaptiveIsosurfaceMeshFilter.h"

namespace adaptiso::detail {

Extraction extractInFilter(itk::ProcessObject& filter, const VolumeView& volume,
                           ExtractionOptions options, Border border) {
    const std::function<void()> endIfAborted = [&] {
        if (filter.GetAbortGenerateData()) throw itk::ProcessAborted("adaptiso", 0);
    };
    options.progress = [&](std::string_view, double fraction) {
        // a stage after the first starts at 0 again; progress never goes back
        filter.UpdateProgress(std::max(filter.GetProgress(), static_cast<float>(fraction)));
        endIfAborted();
    };
    try {
        const InterruptionCheck check(endIfAborted);
        return extractSurface(volume, options, border);
    } catch (const Error& error) {
        throw itk::ExceptionObject("adaptiso", 0, error.what(), filter.GetNameOfClass());
    }
}

}  // namespace adaptiso::detail
