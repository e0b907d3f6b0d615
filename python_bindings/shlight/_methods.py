# SPDX-License-Identifier: MIT
"""What `method=` of the coefficient and shading functions names.

The package has one method for each: "exact" and "auto". The others are there to compare with, in the module
shlight_tools, which `./dev setup` builds in shlight's source tree and which no wheel holds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from shlight import _core


def coefficient_function(name: str, method: Any, **options: Any) -> Callable[..., Any]:
    """A method's function of flat arrays, an order, a flag to clip and a number of threads.

    name: as the package's own is called, "sphere_coefficients" or its like. options: tolerance, samples, seed and
    sampling, None where not given. Raises ValueError naming `method` or an option.
    """
    if is_own("exact", method):
        refuse_options(method, options)
        own: Callable[..., Any] = getattr(_core, name)
        return own
    from shlight_tools import methods

    return methods.coefficient_function(name, method, **options)


def shading_function(name: str, method: Any, order: int, **options: Any) -> Callable[..., Any]:
    """Another method's function of flat float64 arrays, a material, views for each light and a number of threads.

    order: 0 if none was given. name, options and errors: as of coefficient_function.
    """
    from shlight_tools import methods

    return methods.shading_function(name, method, order, **options)


def is_own(own: str, method: Any) -> bool:
    """Whether a method is the package's own. Raises ValueError naming `method` if not, and there are no others."""
    if isinstance(method, str) and method == own:
        return True
    try:
        from shlight_tools import methods  # noqa: F401
    except ImportError as error:
        place = "the module shlight_tools, which `./dev setup` builds in shlight's source tree"
        raise ValueError(f"method must be {own!r}: others need {place} ({error})") from None
    return False


def refuse_options(method: str, options: dict[str, Any]) -> None:
    """Raises ValueError naming an option that was given and that the method does not have."""
    for name, value in options.items():
        if value is not None:
            raise ValueError(f"{name} does not apply to method {method!r}")
