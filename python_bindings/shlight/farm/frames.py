# SPDX-License-Identifier: MIT
"""Numbers of frames, and the names of their files."""

from __future__ import annotations

import re
from pathlib import Path

MOST_FRAMES = 1 << 20  # the largest frame of Blender
PNG = ".png"  # the ending of pictures for display; others are OpenEXR


def parse_frames(text: str) -> list[int]:
    """The frames that a text such as "7", "1-250", "1-250:10" or "1,5,10-20" names, ascending.

    Raises ValueError for another text, or a frame above 1048576.
    """
    frames: set[int] = set()
    for part in text.split(","):
        match = re.fullmatch(r"(\d{1,7})(?:-(\d{1,7})(?::(\d{1,7}))?)?", part.strip())
        first, last, step = (int(number) if number else None for number in match.groups()) if match else (None,) * 3
        if first is None or step == 0 or not first <= (first if last is None else last) <= MOST_FRAMES:
            raise ValueError(f"frames must be numbers and ranges such as 1-250 or 1-250:10, got '{part}'")
        frames.update(range(first, (first if last is None else last) + 1, step or 1))
    return sorted(frames)


def file_of(out: str, frame: int, view: str) -> Path:
    """The file of a picture: the last # of `out` become the frame's number, and the view's part follows it."""
    path = Path(out)
    stem, suffix = (path.stem, path.suffix) if path.suffix else (path.name, ".exr")
    marks = re.findall("#+", stem)
    if marks:
        before, after = stem.rsplit(marks[-1], 1)
        stem = f"{before}{frame:0{len(marks[-1])}d}{after}"
    return path.with_name(f"{stem}{view}{suffix}")


def check_out(out: str, frames: int) -> None:
    """Raises ValueError where `out` cannot name the files of so many frames."""
    path = Path(out)
    if not path.name or "\0" in out:
        raise ValueError("out must name a file")
    if path.suffix not in ("", ".exr", PNG):
        raise ValueError(f"out must end in .exr or .png, got '{out}'")
    if "#" in str(path.parent):
        raise ValueError("out must have # in the file's name only")
    if frames > 1 and "#" not in path.name:
        raise ValueError(f"out must have # where the frame's number goes, as in shot_####.exr, got '{out}'")
