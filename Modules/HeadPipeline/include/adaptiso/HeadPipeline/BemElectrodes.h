#pragma once

#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// Checks what is known of the electrodes before there is a head.
/// \throws InvalidInput  the file has neither a frame nor landmarks, or no electrode
void checkElectrodes(const BemModel& model);

/// Puts on the model's skin what model.options.electrodes asks for (stage "electrodes"): brings
/// electrodes into the model's space by the frame told or, for frames of their own, by the rigid
/// move that takes the file's landmarks to the head's; moves each to the nearest place of the skin;
/// or computes a system of positions from the landmarks. Landmarks are those given, else the
/// file's, else guessed. Fills the model's electrodes, notes and warnings. \pre model.hasModel(),
/// with a skin; checkElectrodes() \throws InvalidInput  an electrode more than 60 mm from the skin
/// (another frame or unit); positions without
///                       landmarks
void placeElectrodes(BemModel& model, const BemHooks& hooks);

}  // namespace adaptiso
