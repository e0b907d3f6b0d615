# SPDX-License-Identifier: MIT
"""Lets the tests import their shared helpers from this directory."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parent))
