#include "adaptiso/Preprocessing/Preprocess.h"

/// A build without ITK, whose interpolators resample.
namespace adaptiso {

Volume resampleVolume(const VolumeView&, double, Interpolation) {
    throw InvalidInput("this build doesn't resample; use the programs");
}

}  // namespace adaptiso
