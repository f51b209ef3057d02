#pragma once

#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// Puts on the model's skin what model.options.electrodes asks for (stage "electrodes"): brings
/// electrodes into the model's space by the frame told or, for frames of their own, by the rigid
/// move that takes the file's landmarks to the head's; moves each to the nearest place of the skin;
/// or computes a system of positions from the landmarks. Landmarks are those given, else the
/// file's, else guessed. Fills the model's electrodes, notes and warnings. \pre model.hasModel(),
/// with a skin \throws InvalidInput  an electrode more than 60 mm from the skin (another frame or
/// unit); positions without
///                       landmarks
void placeElectrodes(BemModel& model, const BemHooks& hooks);

}  // namespace adaptiso
