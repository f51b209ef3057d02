#pragma once

#include <vtkAlgorithm.h>

#include <functional>
#include <string>
#include <string_view>

#include "adaptiso/Core/Progress.h"

namespace adaptiso::vtk {

/// Work of this library inside a VTK filter: progress events out, AbortExecute in (from VTK 9.3 on
/// of filters upstream too).
class FilterRun {
public:
    explicit FilterRun(vtkAlgorithm& filter) : filter_(filter) {}

    /// Progress of part `part` of `parts` equal ones.
    ProgressCallback progress(int part = 0, int parts = 1);

    /// \return  why the work failed, one line; empty where it is done or was aborted
    std::string run(const std::function<void()>& work);
    bool isAborted() const { return isAborted_; }

private:
    void endIfAborted() const;

    vtkAlgorithm& filter_;
    bool isAborted_ = false;
};

}  // namespace adaptiso::vtk
