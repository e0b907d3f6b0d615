# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's depsgraph to a shlight.Scene."""

from ..frame import Frame, frame_of, whole_frame
from ..report import ExportError, ExportReport
from .camera import Eye
from .scene import ExportedScene, export_scene, only_cameras_changed
from .settings import RenderSettings, render_settings

__all__ = [
    "ExportError",
    "ExportReport",
    "ExportedScene",
    "Eye",
    "Frame",
    "RenderSettings",
    "export_scene",
    "frame_of",
    "only_cameras_changed",
    "render_settings",
    "whole_frame",
]
