# SPDX-License-Identifier: MIT
"""Frames, and tiles of large stills, rendered by many processes on one machine or on many, through Dask distributed.

`render_frames` is what `shlight render` does. Dask is imported where more than this process renders.
"""

from shlight.farm.frames import parse_frames
from shlight.farm.pictures import Picture, Rendered, Source
from shlight.farm.render import Outcome, render_frames
from shlight.farm.tls import Tls

__all__ = ["Outcome", "Picture", "Rendered", "Source", "Tls", "parse_frames", "render_frames"]
