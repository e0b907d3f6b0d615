# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct light in materials of Cycles, by a script of Open Shading Language."""
