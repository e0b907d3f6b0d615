# SPDX-License-Identifier: MIT
"""`./dev bench`: how long the calls of the package take, as ratios that hold from one machine to the next.

sections.py lists what is measured, calls.py and pictures.py make the calls, inputs.py and lamps.py their lights,
rounds.py is the clock, builds.py times two builds in turns, command.py is the command.
"""
