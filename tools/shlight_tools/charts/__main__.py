# SPDX-License-Identifier: MIT
"""`python -m shlight_tools.charts`, which `./dev charts` runs."""

import sys

from shlight.commands import run_to_exit

from .command import main

sys.exit(run_to_exit("./dev charts", lambda: main(sys.argv[1:])))
