# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's depsgraph to a shlight.Scene."""

from ..frame import Frame, frame_of, whole_frame
from ..report import ExportError, ExportReport
from .camera import Eye, aperture_of, panorama_of, set_panorama, set_projection
from .changes import Changes, changes_of, everything, motion_of
from .scene import ExportedScene, export_scene
from .settings import preview_settings, render_settings, stroke_settings, viewport_settings

__all__ = [
    "Changes",
    "ExportError",
    "ExportReport",
    "ExportedScene",
    "Eye",
    "Frame",
    "aperture_of",
    "changes_of",
    "everything",
    "export_scene",
    "frame_of",
    "motion_of",
    "panorama_of",
    "preview_settings",
    "render_settings",
    "set_panorama",
    "set_projection",
    "stroke_settings",
    "viewport_settings",
    "whole_frame",
]
