# SPDX-License-Identifier: MIT
"""`./dev charts`: how fast and how accurate the methods are, and where each fails, measured and drawn.

A figure is a function in a module of this package and a line in figures.py. Nothing here needs matplotlib before a
figure is drawn.
"""
