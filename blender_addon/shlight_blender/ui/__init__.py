# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine in Blender's windows: `panels` adds what the other modules have, and joins Blender's own panels."""
