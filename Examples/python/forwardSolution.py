"""From a T1 to MNE's forward solution, without FreeSurfer.

forwardSolution.py: the scan ch2 of Debian's mricron-data, electrodes of the 10-20 system.
"""

import adaptiso
import mne
import numpy as np

mne.set_log_level("ERROR")
SCANS = "/usr/share/mricron/templates/"
# left ear, nasion, right ear on the scan, scanner RAS mm
MARKS = [(-86, -20, -48), (0, 87, -40), (86, -20, -48)]

model = adaptiso.bem(SCANS + "ch2.nii.gz", brain_mask=SCANS + "ch2bet.nii.gz", vertices=642)
bem = mne.make_bem_solution(model.to_mne())
montage = mne.channels.make_standard_montage("standard_1020")
info = mne.create_info(montage.ch_names, sfreq=1000, ch_types="eeg").set_montage(montage)
head = [dig["r"] for dig in info["dig"] if dig["kind"] == mne.io.constants.FIFF.FIFFV_POINT_CARDINAL]
middle = model.surfaces["outer_skin"].to_nibabel_freesurfer()[2]["cras"]  # where tkRAS is 0, 0, 0
fitted = mne.coreg.fit_matched_points(head, (np.array(MARKS) - middle) / 1000, out="trans")
trans = mne.transforms.Transform("head", "mri", fitted)
sources = mne.setup_volume_source_space(pos=15.0, bem=bem)
forward = mne.make_forward_solution(info, trans, sources, bem, meg=False, mindist=5.0)

print(model)
channels, columns = forward["sol"]["data"].shape
print(f"leadfield of {channels} electrodes and {columns // 3} dipoles in 3 directions each")
