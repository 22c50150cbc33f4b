#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lays the segmentation of `trephine export CASE --format dicom-seg --series FOLDER --out OBJECTS` over its CT, with pydicom and numpy.

    python3 overlay.py OBJECTS SLICE PICTURE.ppm     SLICE counts from 1; prints what lies on the slice, with codes and ml"""
import pathlib
import sys

import numpy as np
import pydicom

objects, slice_number, picture = pathlib.Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
seg = pydicom.dcmread(next(objects.glob("*.seg.dcm")))
ct = pydicom.dcmread(sorted((objects / "dicom-ct").iterdir())[slice_number - 1])


def srgb(lab):
    """RecommendedDisplayCIELabValue, CIELab of D65 in 16 bits, as sRGB from 0 to 1."""
    light, a, b = lab[0] / 655.35, lab[1] / 257 - 128, lab[2] / 257 - 128
    y = (light + 16) / 116
    curve = [t ** 3 if t ** 3 > 216 / 24389 else (116 * t - 16) * 27 / 24389 for t in (y + a / 500, y, y - b / 200)]
    linear = np.array([[3.2405, -1.5371, -0.4985], [-0.9693, 1.8760, 0.0416], [0.0556, -0.2040, 1.0572]]) @ (
        np.array(curve) * [0.95047, 1, 1.08883])
    return np.clip(np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.abs(linear) ** (1 / 2.4) - 0.055), 0, 1)


segments = {s.SegmentNumber: s for s in seg.SegmentSequence}
bits = np.unpackbits(np.frombuffer(seg.PixelData, np.uint8), bitorder="little")  # frames follow each other without padding
frames = bits[:seg.NumberOfFrames * seg.Rows * seg.Columns].reshape(-1, seg.Rows, seg.Columns).astype(bool)
measures = seg.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0]
hu = ct.pixel_array * float(ct.RescaleSlope) + float(ct.RescaleIntercept)
image = np.repeat(np.clip((hu + 60) / 220, 0, 1)[:, :, None], 3, axis=2)
for frame, groups in zip(frames, seg.PerFrameFunctionalGroupsSequence):
    source = groups.DerivationImageSequence[0].SourceImageSequence[0]
    if source.ReferencedSOPInstanceUID != ct.SOPInstanceUID:
        continue
    s = segments[groups.SegmentIdentificationSequence[0].ReferencedSegmentNumber]
    image[frame] = 0.6 * image[frame] + 0.4 * srgb(s.RecommendedDisplayCIELabValue)
    code = s.SegmentedPropertyTypeCodeSequence[0]
    ml = frame.sum() * np.prod([float(mm) for mm in measures.PixelSpacing]) * float(measures.SliceThickness) / 1000
    print(f"{s.SegmentLabel}: {code.CodeMeaning} ({code.CodingSchemeDesignator} {code.CodeValue}), {ml:.2f} ml on this slice")
pathlib.Path(picture).write_bytes(b"P6 %d %d 255\n" % (ct.Columns, ct.Rows) + (255 * image).astype(np.uint8).tobytes())
