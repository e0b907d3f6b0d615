# SPDX-License-Identifier: MIT
"""shlight's shading as a function of PyTorch, with the exact derivatives backwards.

usage: python examples/torch_shading.py      (pip install torch)

`forward` and `backward` are numpy; `torch_function` wraps them in a torch.autograd.Function, and `main` moves a lamp
until a matte point is as bright as wanted. shlight itself does not need torch.
"""

from __future__ import annotations

import importlib.util
import sys
from typing import Any

import numpy as np
import numpy.typing as npt

import shlight
from shlight import Bsdf, SphereGradient

Array = npt.NDArray[Any]


def forward(centers: Array, radii: Array, bsdf: Bsdf, cos_theta_o: Array) -> tuple[Array, SphereGradient]:
    """Radiance (n, 3) of n sphere lights, and what `backward` takes."""
    return shlight.shade_spheres(centers, radii, bsdf, cos_theta_o, gradient="places")


def backward(gradient: SphereGradient, by_radiance: Array) -> tuple[Array, Array]:
    """Derivatives of a loss by centres (n, 3) and radii (n), from those by radiance (n, 3): sums over RGB."""
    by_centers = np.einsum("nc,ncx->nx", by_radiance, gradient.center)
    return by_centers, np.einsum("nc,nc->n", by_radiance, gradient.radius)


def torch_function(torch: Any) -> Any:
    """The torch.autograd.Function of centres and radii, tensors on the processor, a Bsdf and cosines."""

    class ShadeSpheres(torch.autograd.Function):  # type: ignore[misc]
        @staticmethod
        def forward(ctx: Any, centers: Any, radii: Any, bsdf: Bsdf, cos_theta_o: Array) -> Any:
            value, ctx.gradient = forward(centers.detach().numpy(), radii.detach().numpy(), bsdf, cos_theta_o)
            return torch.from_numpy(value).to(centers.dtype)

        @staticmethod
        def backward(ctx: Any, by_radiance: Any) -> Any:
            by_centers, by_radii = backward(ctx.gradient, by_radiance.numpy())
            return torch.from_numpy(by_centers), torch.from_numpy(by_radii), None, None

    return ShadeSpheres


def main() -> None:
    if importlib.util.find_spec("torch") is None:
        sys.exit("torch_shading.py needs PyTorch, which shlight does not: pip install torch")
    import torch

    shade = torch_function(torch).apply
    center = torch.tensor([[0.5, 0.5, 2.0]], dtype=torch.float64, requires_grad=True)
    radius = torch.tensor([0.3], dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.Adam([center, radius], lr=0.02)
    wanted = 0.02
    for _ in range(200):
        optimizer.zero_grad()
        loss = ((shade(center, radius, Bsdf.lambert(0.8), np.array([0.8])) - wanted) ** 2).sum()
        loss.backward()
        optimizer.step()
    print(f"radiance {wanted} from a lamp of radius {radius.item():.3f} at {center.detach().numpy()[0].round(3)}")


if __name__ == "__main__":
    main()
