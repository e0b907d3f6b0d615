# SPDX-License-Identifier: MIT
"""usage: python -P serve.py FOLDER SECTION LIGHTS

Makes the calls of a section of this bench with the package shlight that is in FOLDER: prints their names, and then, for
each name that it is given, the seconds that the call took.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from importlib.machinery import PathFinder
from pathlib import Path


def main(folder: str, section: str, lights: int) -> None:
    # Before what an editable installation redirects to its own place.
    sys.meta_path.insert(0, PathFinder)
    sys.path[:0] = [folder, str(Path(__file__).parents[2])]
    run = importlib.import_module("shlight_tools.bench.run").Run(section, lights, 1)
    works = importlib.import_module("shlight_tools.bench.sections").works(run)
    print(json.dumps(list(works)), flush=True)
    for line in sys.stdin:
        call = works[line.rstrip("\n")].call
        start = time.process_time()
        call()
        print(time.process_time() - start, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
