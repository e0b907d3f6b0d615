# SPDX-License-Identifier: MIT
"""`shlight bench`: how long the library's kernels take, as ratios that hold from one machine to the next.

sections.py lists what can be measured: each section is a module with a function measure(run) that returns rows.
rounds.py is the clock, inputs.py the lights, command.py the command.
"""
