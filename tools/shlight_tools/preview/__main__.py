# SPDX-License-Identifier: MIT
"""`python -m shlight_tools.preview`, which `./dev preview` runs."""

import sys

from shlight.commands import run_to_exit

from .command import main

sys.exit(run_to_exit("./dev preview", lambda: main(sys.argv[1:])))
