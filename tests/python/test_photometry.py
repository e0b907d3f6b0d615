# SPDX-License-Identifier: MIT
from __future__ import annotations

import numpy as np
import pytest

import shlight
from shlight import nodes


def test_luminous_weighs_rgb_as_rec_709_does() -> None:
    np.testing.assert_allclose(shlight.luminous(np.eye(3)), [145.2555907, 488.4489526, 49.295525], rtol=1e-9)
    assert shlight.luminous(2.0) == 2 * 683
    assert nodes.Color(1, 0, 0).as_number().constant == pytest.approx(shlight.luminous((1, 0, 0)) / 683, rel=1e-7)
    assert shlight.luminous(np.ones((4, 5, 3), np.float32)).dtype == np.float32
    with pytest.raises(ValueError, match=r"^irradiance\[1, 2\] must be finite"):
        shlight.luminous(np.where(np.arange(24).reshape(2, 4, 3) == 18, np.inf, 1.0))
