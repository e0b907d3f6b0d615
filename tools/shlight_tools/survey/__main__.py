# SPDX-License-Identifier: MIT
"""`python -m shlight_tools.survey`, which `./dev survey` runs."""

import sys

from shlight.commands import run_to_exit

from .command import main

sys.exit(run_to_exit("./dev survey", lambda: main(sys.argv[1:])))
