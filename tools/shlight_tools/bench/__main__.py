# SPDX-License-Identifier: MIT
"""`python -m shlight_tools.bench`, which `./dev bench` runs."""

import sys

from shlight.commands import run_to_exit

from .command import main

sys.exit(run_to_exit("./dev bench", lambda: main(sys.argv[1:])))
