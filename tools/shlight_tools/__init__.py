# SPDX-License-Identifier: MIT
"""What shlight is compared and measured with; for developers, in no wheel.

methods.py has other ways to the same numbers, charts/ measures and draws them, bench/ times the package's calls and
pictures, preview/ and survey/ compare Blender's scenes with Cycles.
"""
