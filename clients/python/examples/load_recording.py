# SPDX-License-Identifier: Apache-2.0
# Prints the content of a recording: python3 clients/python/examples/load_recording.py FILE.xdf

# %%
import sys

import numpy as np

import dts

recording = dts.load(sys.argv[1])
print(recording)

# %% Streams are arrays: scans x channels, with segment, scan and time of each row.
for name, stream in recording.streams.items():
    if not stream.rate or not len(stream) or stream.values.dtype == object:  # an object is a text
        continue
    for channel, unit, values in zip(stream.channels, stream.units, stream.values.T, strict=True):
        known = values[~np.isnan(values)]
        text = f"mean {known.mean():10.4f}  deviation {known.std():8.4f} {unit}" if len(known) else "no values"
        print(f"{name:18} {channel:12} {text}")

# %% Events have a segment, a scan and a time; use the time to find the rows between two events.
for event in recording.events:
    print(f"{event.utc}  {event}")
